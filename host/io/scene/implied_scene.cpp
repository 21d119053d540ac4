#include "io/scene/implied_scene.hpp"

#include <toml++/toml.h>

#include <algorithm>

#include "core/error.hpp"
#include "io/e57/e57_source.hpp"
#include "io/input_file.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "io/text/plain_text.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

namespace fs = std::filesystem;

bool is_range_image(const fs::path& file) {
  return lower_case(file.extension().string()) == ".exr";
}

bool can_be_listed(const fs::path& file) {
  try {
    list_scans(file);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    if (std::error_code ignored; entry->is_regular_file(ignored)) entries.push_back(entry->path());
  if (code) fail_input("{}: cannot be read ({}); change its permissions", folder.string(), code.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

SceneFile read_scene_in(const fs::path& folder) {
  std::vector<fs::path> scenes;
  for (const fs::path& file : entries_of(folder)) {
    if (file.filename() == "scene.toml") return read_scene_file(file);
    if (has_scene_name(file)) scenes.push_back(file);
  }
  if (scenes.size() == 1) return read_scene_file(scenes.front());
  if (scenes.size() > 1)
    fail_input("{}: expected one scene, found {} and {} more; name the one that is meant", folder.string(),
               scenes[0].filename().string(), scenes.size() - 1);
  for (const fs::path& file : entries_of(folder))
    if (is_scene_by_another_name(file))
      fail_input(
          "{}: expected a scene.toml or one *.scene.toml, found {}, a scene file by another name; name it, "
          "or rename it",
          folder.string(), file.filename().string());
  const auto scans = scans_in_folder(folder);
  if (scans.empty())
    fail_input("{}: expected a scene file, found a folder with neither a scene.toml nor scans ({}) in it",
               folder.string(), scan_extensions());
  return implied_scene(folder, scans);
}

}  // namespace

SceneFile implied_scene(const fs::path& place, const std::vector<fs::path>& scans) {
  const fs::path whole = fs::absolute(place).lexically_normal();
  const bool folder = scans.size() != 1 || scans.front() != place;
  SceneFile scene;
  scene.implied = true;
  scene.path = folder ? place / "" : place;  // its folder is that of the scans
  scene.name = folder ? (whole.has_filename() ? whole : whole.parent_path()).filename().string()
                      : whole.stem().string();
  if (scene.name.empty()) scene.name = "scans";  // of the root
  for (const fs::path& file : scans) {
    SceneScan scan;
    scan.file = file;
    scene.scans.push_back(std::move(scan));
  }
  return scene;
}

bool belongs_to_range_image(const fs::path& file, const std::vector<fs::path>& beside) {
  return file.filename() == "extra.ply" && std::any_of(beside.begin(), beside.end(), is_range_image);
}

bool holds_photographs_alone(const fs::path& file) {
  if (lower_case(file.extension().string()) != ".e57") return false;
  try {
    const E57File opened(file, {.salvage = true});
    return opened.contents().scans.empty() && !opened.contents().images.empty();
  } catch (const Error&) {
    return false;  // who reads it will tell
  }
}

bool has_scene_name(const fs::path& file) {
  const std::string name = file.filename().string();
  return name == "scene.toml" || name.ends_with(".scene.toml");
}

bool is_scene_by_another_name(const fs::path& file) {
  if (file.extension() != ".toml" || file.filename().string().starts_with(".") || has_scene_name(file))
    return false;
  try {
    const toml::table document = toml::parse(read_plain_text(file), file.string());
    const toml::node *scans = document.get("scan"), *model = document.get("model"),
                     *scene = document.get("scene");
    return (scans != nullptr && scans->is_array_of_tables()) || (model != nullptr && model->is_table()) ||
           (scene != nullptr && scene->is_table());
  } catch (const std::exception&) {
    return false;
  }
}

std::vector<fs::path> scans_in_folder(const fs::path& folder) {
  const auto entries = entries_of(folder);
  std::vector<fs::path> scans;
  for (const fs::path& file : entries)
    if (has_scan_extension(file) && !file.filename().string().starts_with(".") &&
        !belongs_to_range_image(file, entries) && (!is_range_image(file) || can_be_listed(file)) &&
        !holds_photographs_alone(file))
      scans.push_back(file);
  return scans;
}

SceneFile read_scene_of(const fs::path& folder_or_scan) {
  std::error_code code;
  if (fs::is_directory(folder_or_scan, code)) return read_scene_in(folder_or_scan);
  check_readable(folder_or_scan);
  return implied_scene(folder_or_scan, {folder_or_scan});
}

}  // namespace hybrid::io
