#include "batch/scene_request.hpp"

#include <algorithm>

#include "batch/editing/edit_unit.hpp"
#include "batch/output_folder.hpp"
#include "core/error.hpp"
#include "io/scene/map_shift.hpp"

namespace hybrid::batch {

namespace fs = std::filesystem;

namespace {

// Scans alone, to be registered to each other.
bool is_without_pictures(const io::SceneFile& scene) {
  return !scene.model && !scene.photographs && scene.views.empty() && scene.edits.remove_faces.empty() &&
         scene.edits.holes.empty();
}

void choose_stages(const io::SceneFile& scene, const RunRequest& request, std::set<std::string>& stages) {
  if (asks_for_export(scene, request.assignments)) stages.insert("export");
  if (is_without_pictures(scene) && !request.leave_one_out)
    for (const char* stage : {"edit", "render"}) stages.erase(stage);
}

Pose file_from_scan(const io::SceneScan& entry) {
  return {1, io::file_from_scanner(entry.axes).rotation, entry.scanner.value_or(Vec3::Zero())};
}

}  // namespace

io::SceneFile read_scene(const RunRequest& request, std::set<std::string>& stages, StageOptions& options) {
  auto scene = request.scene ? *request.scene : io::read_scene_file(request.scene_file);
  options = read_stage_options(scene, request.assignments);
  options.set_tile(request.tile);
  if (request.seed) options.set_seed(*request.seed);
  if (request.square) options.set_square(*request.square);
  if (request.stages_by_scene) choose_stages(scene, request, stages);
  if (stages.count("report")) {  // its page shows the others' files
    stages.insert("planes");
    if (scene.model) stages.insert({"register", "edit", "render"});
  }
  if ((stages.count("edit") || stages.count("render")) && !scene.model)
    fail_input("{}: no [model]: editing and rendering need one; add it, or use --only planes,register,report",
               scene.path.string());
  if (stages.count("register") && !scene.model && scene.scans.empty())
    fail_input("{}: no [model] and no [[scan]]: there is nothing to register", scene.path.string());
  const auto named = [&](const auto& view) {
    return view.name == request.only_view || view.path == request.only_view;
  };
  if (!request.only_view.empty() && std::none_of(scene.views.begin(), scene.views.end(), named))
    fail_input("--view {}: {} has no view or path of that name", request.only_view, scene.path.string());
  if (request.leave_one_out && !scene.photographs)
    fail_input("--leave-one-out: {} has no [photographs]", scene.path.string());
  std::error_code ignored;
  if (scene.implied && fs::equivalent(request.out, scene.scans.front().file.parent_path() / ".", ignored))
    fail_input(
        "{}: holds the scans themselves, and where results lie nobody looks for scans; choose another "
        "--out",
        request.out.string());
  check_output_folder(request.out, scene.name, request.scene_file, request.force);
  return scene;
}

void check_edited_scans_early(const io::SceneFile& scene, bool salvage) {
  if (!edits_name_other_scans(scene, ScanNames(scene).taken())) return;
  if (const auto ids = scan_ids(scene, salvage)) check_edited_scans(scene, *ids);
}

io::SceneScan in_scan_frame(io::SceneScan entry, const Vec3& shift) {
  if (entry.scanner || entry.axes != io::ScanAxes::z_up) {
    const Pose file = file_from_scan(entry), scan_from_file = file.inverse();
    for (io::SceneLandmark& landmark : entry.landmarks)
      if (landmark.scan) landmark.scan = scan_from_file * *landmark.scan;
    if (entry.pose) entry.pose = row_major(pose_from_row_major(*entry.pose) * file);
  }
  if (entry.pose) {
    auto& matrix = *entry.pose;
    const Vec3 translation = io::off_map({matrix[3], matrix[7], matrix[11]}, shift);
    matrix[3] = translation.x(), matrix[7] = translation.y(), matrix[11] = translation.z();
  }
  return entry;
}

Pose in_file_frame(const io::SceneScan& entry, const Pose& world_from_scan) {
  return world_from_scan * file_from_scan(entry).inverse();
}

std::string relative_name(const fs::path& file, const io::SceneFile& scene) {
  return fs::proximate(file, fs::absolute(scene.path).parent_path()).generic_string();
}

}  // namespace hybrid::batch
