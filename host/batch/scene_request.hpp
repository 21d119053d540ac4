#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "batch/scene_run.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// What a run is asked for, before it opens any input.

// The scene file with the request's options; checks what can be checked before any input is opened, and adds
// to `stages` those that others need.
io::SceneFile read_scene(const RunRequest& request, std::set<std::string>& stages, StageOptions& options);

// Throws as check_edited_scans() where no scan of the scene is one that an edit names. Files are listed for
// that only where no entry's id is it, and one that cannot be listed leaves it open.
void check_edited_scans_early(const io::SceneFile& scene, bool salvage);

// What the scene file says in the file's coordinates, in the scanner's frame; its pose without the scene's
// shift (io::off_map).
io::SceneScan in_scan_frame(io::SceneScan entry, const Vec3& shift = Vec3::Zero());
// The other way round: a pose of the scanner's frame as the entry says it.
Pose in_file_frame(const io::SceneScan& entry, const Pose& world_from_scan);

// As seen from the scene file: in summary.json no path may be absolute.
std::string relative_name(const std::filesystem::path& file, const io::SceneFile& scene);

}  // namespace hybrid::batch
