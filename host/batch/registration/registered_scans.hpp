#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "geometry/scan.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// [register] write = "ply, las, e57": every sample of a registered scan in a file of its own,
// scans/<id>/registered.<format>. Nothing is thinned, clipped or edited.

// What `write` says, of e57 las pcd ply pts ptx; nothing where it is empty. Throws ErrorKind::input naming
// the word that is no format.
std::set<std::string> registered_formats(const std::string& write);

// The scan with the pose in its samples: points in world + shift, double precision where they are large
// numbers; no-returns stay such. It has no pose and no grid that a reader might turn again.
Scan moved_into_world(Scan scan, const Pose& world_from_scan, const io::SceneFile& scene);

// Writes the formats and removes those of an earlier run that are not among them. Formats with a pose (E57,
// PTX, PCD) get the samples as scanned and the registered pose, the others the samples in world + shift; all
// that can name scene.crs. `read` gives the scan as its file has it; it is read once per format, so that one
// copy is in memory. Returns, per file, its name, bytes, samples and what the format dropped or changed.
nlohmann::ordered_json write_registered_scan(const std::filesystem::path& folder,
                                             const std::set<std::string>& formats,
                                             const std::function<Scan()>& read, const Pose& world_from_scan,
                                             const io::SceneFile& scene);

// Removes what an earlier run wrote: of a scan without a pose now.
void remove_registered_scan(const std::filesystem::path& folder);

}  // namespace hybrid::batch
