#include "small_archive.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <vector>

#include "../e2e/bad_mini_scene.hpp"
#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

bool tells_of_the_run(const fs::path& file) {
  const auto name = file.filename();
  return name == "record.json" || is_timing(name) || name == "log.txt";
}

std::vector<std::string> made_in(const fs::path& folder) {
  std::vector<std::string> lines;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !tells_of_the_run(entry.path()))
      lines.push_back(fs::relative(entry.path(), folder).string() + " " + io::fingerprint(entry.path()).xxh3);
  return lines;
}

std::string join(std::vector<std::string> lines) {
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return text;
}

// The lowest bit of a byte, counted from the file's end.
void change_byte(const fs::path& file, std::size_t from_end) {
  std::string bytes = io::read_text(file);
  bytes[bytes.size() - from_end] = static_cast<char>(bytes[bytes.size() - from_end] ^ 1);
  io::write_text(file, bytes);
}

}  // namespace

void write_small_archive(const fs::path& archive, int scenes) {
  for (int i = 0; i < scenes; ++i) {
    const fs::path scene = archive / std::string(1, static_cast<char>('a' + i));
    write_mini_scene(scene);
    change_byte(scene / "s.ply", 12 * static_cast<std::size_t>(i) + 2);
  }
}

FirstNight::FirstNight() {
  static const Scratch made;
  if (!fs::exists(made / "store")) {
    write_small_archive(made / "archive", 3);
    const auto planned = plan(made / "archive", made / "store");
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    const auto ran = run_store(made / "store");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(json_of(ran)["computed"], 7);
  }
  fs::copy(made.path(), scratch.path(), fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  EXPECT_EQ(plan(archive, store).exit_code, 0);
}

void change_scan(const fs::path& scene) {
  change_byte(scene / "s.ply", 2402);
}

Outcome plan(const fs::path& archive, const fs::path& store, const std::string& options) {
  return run("hybrid batch plan '" + archive.string() + "' --out '" + store.string() + "' --json " + options);
}
Outcome run_store(const fs::path& store, const std::string& options) {
  return run("hybrid batch run --out '" + store.string() + "' --jobs 1 --threads 2 --json " + options);
}

nlohmann::json json_of(const Outcome& outcome) {
  auto json = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << outcome.out << outcome.err;
  return json;
}
nlohmann::json status_of(const fs::path& store) {
  return json_of(run("hybrid batch status '" + store.string() + "' --json"));
}

std::string made_for(const fs::path& store, const std::string& scene) {
  return join(made_in(fs::canonical(store / "results" / scene / "scene")));
}

std::string results_of(const fs::path& store) {
  auto lines = made_in(store / "objects");
  for (const auto& entry : fs::recursive_directory_iterator(store / "results"))
    if (entry.is_symlink())
      lines.push_back(entry.path().lexically_relative(store).string() + " -> " +
                      fs::read_symlink(entry.path()).string());
  return join(lines);
}

std::map<std::string, std::string> stamps_of(const fs::path& store) {
  std::map<std::string, std::string> stamps;
  for (const auto& entry : fs::recursive_directory_iterator(store)) {
    struct stat found {};
    lstat(entry.path().c_str(), &found);
    stamps[entry.path().lexically_relative(store).string()] =
        fmt::format("{} {}.{} {}.{}", found.st_ino, found.st_mtim.tv_sec, found.st_mtim.tv_nsec,
                    found.st_ctim.tv_sec, found.st_ctim.tv_nsec);
  }
  return stamps;
}

}  // namespace hybrid::e2e
