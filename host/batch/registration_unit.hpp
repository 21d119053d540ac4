#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "batch/scan_unit.hpp"
#include "io/scene_file.hpp"

namespace hybrid::batch {

// Share of a scan's wall samples near the proxy: wall samples are measured samples of superclusters whose
// plane is within 30 degrees of vertical in the world (floors and ceilings hide horizontal errors).
struct WallShare {
  std::int64_t samples = 0;
  double within_5cm = 0, within_10cm = 0;
};

struct ScanRegistration {
  std::string how;  // "landmarks" | "automatic" | "given"
  bool fixed = false;
  bool abstained = false;  // the automatic alignment did, and there are no landmarks: there is no pose
  Pose start;              // from landmarks, the automatic alignment or the scene file
  std::optional<stages::LandmarkFit> landmarks;
  std::optional<stages::AutomaticAlignment> automatic;
  stages::Registration icp;  // world_from_scan: the result
  WallShare wall_before, wall_after;
  std::vector<float>
      distance_m;  // per node, to the closest compatible face, after ICP; NaN where not measured
  const Pose& world_from_scan() const { return icp.world_from_scan; }
};

// METHOD 5 to 7: landmarks, the scene's pose or the automatic alignment give the start, ICP on the planes the
// result; a pose with fixed = true is final. A scan whose automatic alignment abstains and that has no
// landmarks is returned as such, product unchanged. Then marks the planar samples that a proxy face explains,
// turns superclusters without a face into their contour polygons and gives the other samples back (METHOD 4):
// product.decimation and contour_faces change. Throws ErrorKind::input when neither landmarks nor a pose are
// given and [register] automatic = "never".
ScanRegistration register_scan(device::Queue& queue, const io::SceneScan& entry, const PolygonModel& model,
                               const StageOptions& options, ScanProduct& product, Progress& progress);

// pose.json of SCENE.md.
nlohmann::ordered_json pose_json(const ScanProduct& product, const ScanRegistration& registration);
// The registration's figures for summary.json.
nlohmann::ordered_json registration_figures(const ScanRegistration& registration);

}  // namespace hybrid::batch
