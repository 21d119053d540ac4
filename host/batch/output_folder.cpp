#include "batch/output_folder.hpp"

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
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

std::string called(const std::string& scene) {
  return scene.empty() ? "of single scans (hybrid planes)" : fmt::format("of scene '{}'", scene);
}

}  // namespace

void check_output_folder(const fs::path& out, const std::string& scene, bool force) {
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
    return;
  }
}

void begin_output(const fs::path& out, const std::string& scene) {
  io::create_output_folder(out);
  Json begun = {{"device", nullptr}, {"state", "begun, not ended"}};
  if (!scene.empty()) begun["scene"] = scene;
  io::write_text(out / "timing.json", json_text(begun) + "\n");
  std::error_code code;
  fs::remove(out / "summary.json", code);
  if (code)
    fail(ErrorKind::failed, "{}: cannot be replaced ({}); choose another --out",
         (out / "summary.json").string(), code.message());
}

}  // namespace hybrid::batch
