#include "batch/output_folder.hpp"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/output.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// What a run's own file says of the scene; nothing when the file is no such file.
std::optional<std::string> scene_in(const fs::path& file) {
  const auto document = Json::parse(io::read_text(file), nullptr, false);
  if (!document.is_object()) return std::nullopt;
  if (document.contains("scene"))
    return document["scene"].is_string() ? std::optional(document["scene"].get<std::string>()) : std::nullopt;
  return document.contains("scans") || document.contains("device") ? std::optional<std::string>("")
                                                                   : std::nullopt;
}

// The scene file of the run that wrote this timing.json, where it is another than `scene_file` and still
// there: one that was moved since is the same. Many scenes have the same name, or none.
std::optional<fs::path> other_scene_file(const fs::path& timing, const fs::path& scene_file) {
  std::error_code code;
  if (!fs::exists(timing, code)) return std::nullopt;
  const auto document = Json::parse(io::read_text(timing), nullptr, false);
  const Json inputs = document.is_object() ? document.value("inputs", Json()) : Json();
  if (!inputs.is_array() || inputs.empty() || !inputs[0].is_string()) return std::nullopt;
  const fs::path was = inputs[0].get<std::string>();
  if (!fs::exists(was, code) || fs::equivalent(was, scene_file, code)) return std::nullopt;
  return was;
}

// Below the output folder; beside them summary.json and timing.json.
constexpr std::array kResultFolders = {"scans", "views", "model", "export", "report"};

// Results are written there: in scans/ only below a scan's own folder, for inputs are often kept beside it.
bool is_among_results(const fs::path& out, const fs::path& file) {
  std::error_code code;
  const fs::path in_out =
      fs::weakly_canonical(file, code).lexically_relative(fs::weakly_canonical(out, code));
  if (code || in_out.empty() || *in_out.begin() == "..") return false;
  const auto parts = std::distance(in_out.begin(), in_out.end());
  if (parts == 1) return in_out == "summary.json" || in_out == "timing.json";
  const bool among = std::find(kResultFolders.begin(), kResultFolders.end(), in_out.begin()->string()) !=
                     kResultFolders.end();
  return among && (*in_out.begin() != "scans" || parts > 2);
}

// The lock's descriptor; -1 where the file system knows no locks.
int lock_folder(const fs::path& out) {
  const int descriptor = ::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  const int reason = errno;
  ::close(descriptor);
  if (reason == EWOULDBLOCK)
    fail(ErrorKind::temporary,
         "{}: another run is writing into it; wait until that has ended, or choose another --out",
         out.string());
  return -1;
}

std::string called(const std::string& scene) {
  return scene.empty() ? "of single scans (hybrid planes)" : fmt::format("of scene '{}'", scene);
}

}  // namespace

void check_output_folder(const fs::path& out, const std::string& scene, const fs::path& scene_file,
                         bool force) {
  if (force) return;
  for (const char* name : {"summary.json", "timing.json"}) {
    const fs::path file = out / name;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) continue;
    const auto found = scene_in(file);
    if (!found)
      fail_input(
          "{}: expected a file of an earlier run, found something else; choose another --out or add "
          "--force to replace it",
          file.string());
    if (*found != scene)
      fail_input("{}: holds the results {}, not {}; choose another --out or add --force", out.string(),
                 called(*found), called(scene));
    break;
  }
  if (scene_file.empty()) return;
  if (const auto other = other_scene_file(out / "timing.json", scene_file))
    fail_input("{}: holds the results of {}, not of {}; choose another --out or add --force", out.string(),
               other->string(), scene_file.string());
}

OutputFolder::OutputFolder(const fs::path& out, const std::string& scene, const std::vector<fs::path>& inputs)
    : out_(out) {
  for (const auto& file : inputs)
    if (is_among_results(out, file))
      fail_input(
          "{}: is an input, and results are written over it in {}; choose another --out, or move the input",
          file.string(), out.string());
  io::create_output_folder(out);
  lock_ = lock_folder(out);
  const fs::path timing = out / "timing.json";
  Json begun = {{"device", nullptr}, {"state", "begun, not ended"}};
  if (!scene.empty()) begun["scene"] = scene;
  if (!inputs.empty()) begun["inputs"] = {fs::absolute(inputs.front()).string()};
  io::write_text(timing, json_text(begun) + "\n");
  std::error_code code;
  begun_ = fs::last_write_time(timing, code);
  fs::remove(out / "summary.json", code);
  if (code)
    fail(ErrorKind::failed, "{}: cannot be replaced ({}); choose another --out",
         (out / "summary.json").string(), code.message());
}

OutputFolder::~OutputFolder() {
  if (lock_ >= 0) ::close(lock_);
}

void OutputFolder::warn_of_leftovers() const {
  constexpr std::size_t kNamed = 5;
  std::vector<std::string> old;
  for (const char* folder : kResultFolders) {
    std::error_code code;
    for (fs::recursive_directory_iterator entry(out_ / folder, code), end; !code && entry != end;
         entry.increment(code)) {
      std::error_code unknown;
      if (entry->is_regular_file(unknown) && entry->last_write_time(unknown) < begun_ && !unknown)
        old.push_back(entry->path().lexically_relative(out_).string());
    }
  }
  if (old.empty()) return;
  std::sort(old.begin(), old.end());
  const std::size_t more = old.size() - std::min(old.size(), kNamed);
  old.resize(old.size() - more);
  log::warning("{}: {}{}: left from an earlier run, not made by this one; delete what nobody needs",
               out_.string(), fmt::join(old, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace hybrid::batch
