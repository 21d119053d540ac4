#include "archive/scene_inputs.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "batch/photographs/photograph_files.hpp"
#include "batch/render_unit.hpp"
#include "core/error.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/output.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::archive {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

Files files_in(const fs::path& folder) {
  Files files;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    if (entry->is_regular_file(code)) files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  return files;
}

void append(const Files& more, Files& files) {
  files.insert(files.end(), more.begin(), more.end());
}

// Bundler's list of names, wherever it looks for it.
void append_if_there(const fs::path& file, Files& files) {
  std::error_code code;
  if (fs::is_regular_file(file, code)) files.push_back(file);
}

void append_cameras(const io::SceneFile::Photographs& section, Files& files) {
  const fs::path& path = section.cameras.path;
  switch (section.cameras.format) {
    case io::CameraFormat::colmap:
    case io::CameraFormat::strecha:
      return append(files_in(path), files);
    case io::CameraFormat::bundler:
      files.push_back(path);
      append_if_there(path.string() + ".list.txt", files);
      for (const fs::path& folder : {path.parent_path(), path.parent_path() / ".."})
        for (const fs::path& file : files_in(folder))
          if (file.filename().string().ends_with("list.txt")) files.push_back(file);
      return;
    case io::CameraFormat::nerfstudio:
      files.push_back(path);
      return;
    case io::CameraFormat::e57:
      return append(section.e57_files, files);
  }
}

void append_truth(const fs::path& truth, Files& files) {
  files.push_back(truth);
  const auto document = nlohmann::json::parse(io::read_text(truth), nullptr, false);
  if (!document.is_object() || !document.contains("scans")) return;
  for (const auto& scan : document["scans"])
    if (scan.is_object() && scan.contains("truth_image") && scan["truth_image"].is_string())
      files.push_back(truth.parent_path() / scan["truth_image"].get<std::string>());
}

// What the body cannot read or list, the run will name.
template <typename Body>
void try_to(const Body& body) {
  try {
    body();
  } catch (const std::exception&) {
  }
}

}  // namespace

Files scan_companions(const fs::path& scan) {
  Files files;
  if (io::lower_case(scan.extension().string()) != ".exr") return files;
  append_if_there(scan.parent_path() / "extra.ply", files);
  append(files_in(io::parts_folder(scan)), files);
  return files;
}

Files scene_inputs(const io::SceneFile& scene) {
  Files files;
  if (scene.model) files.push_back(scene.model->file);
  if (scene.photographs) {
    append_cameras(*scene.photographs, files);
    if (scene.photographs->cameras.format != io::CameraFormat::e57)
      try_to([&] {
        const auto cameras =
            io::read_cameras(scene.photographs->cameras, scene.photographs->images).photographs;
        append(batch::find_photographs(*scene.photographs, cameras).all, files);
      });
  }
  if (scene.truth) try_to([&] { append_truth(*scene.truth, files); });
  return files;
}

}  // namespace hybrid::archive
