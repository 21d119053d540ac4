#include "program.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "io/output.hpp"
#include "places.hpp"

namespace hybrid::e2e {
namespace fs = std::filesystem;

Outcome run(const std::string& command_line) {
  const Scratch scratch;
  const std::string line = "PATH=" HYBRID_BIN_DIR ":$PATH; " + command_line;
  io::write_text(scratch / "command.sh", line + "\n");
  const std::string shell = "sh " + (scratch / "command.sh").string() + " >" + (scratch / "out").string() +
                            " 2>" + (scratch / "err").string() + " </dev/null";
  const int status = std::system(shell.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = io::read_text(scratch / "out");
  outcome.err = io::read_text(scratch / "err");
  return outcome;
}

fs::path room() {
  return fs::path(HYBRID_E2E_DIR) / "room";
}
fs::path result() {
  return fs::path(HYBRID_E2E_DIR) / "result";
}

Scratch::Scratch() {
  std::string name = (fs::temp_directory_path() / "hybrid-e2e-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

nlohmann::json json_of(const fs::path& file) {
  return nlohmann::json::parse(io::read_text(file));
}

Pose pose_of(const fs::path& out, const std::string& scan) {
  return pose_from_row_major(
      json_of(out / "scans" / scan / "pose.json")["world_from_scan"].get<std::array<double, 16>>());
}

std::string with_place(std::string scene, const std::filesystem::path& out, const std::string& scan,
                       std::size_t place) {
  const std::string places = io::read_text(out / "scans" / scan / "sheet" / "places.toml");
  const auto begin = places.find("# pose = [", places.find("\n# " + std::to_string(place) + ": "));
  EXPECT_NE(begin, std::string::npos) << places;
  std::string pose = places.substr(begin, places.find("# ]", begin) + 3 - begin) + "\n";
  for (auto at = pose.find("# "); at != std::string::npos; at = pose.find("# ", at)) pose.erase(at, 2);
  const std::string id = "id = \"" + scan + "\"\n";
  EXPECT_NE(scene.find(id), std::string::npos) << scene;
  return scene.insert(scene.find(id) + id.size(), pose);
}

bool is_timing(const fs::path& name) {
  return name == "timing.json" || name == "timing.js";
}

std::string content_list(const fs::path& folder) {
  std::vector<std::string> lines;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || is_timing(entry.path().filename())) continue;
    lines.push_back(fs::relative(entry.path(), folder).string() + " " + io::fingerprint(entry.path()).xxh3);
  }
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return text;
}

}  // namespace hybrid::e2e
