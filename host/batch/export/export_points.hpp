#pragma once
#include <optional>
#include <vector>

#include "batch/registration/registration_unit.hpp"
#include "io/scene/scene_file.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::batch {

// Retained samples of all registered scans in the world frame, without the stray ones; coloured by the
// photographs that see them, else as the scan was, else red (no photographs at all: grey).
struct ExportPoints {
  std::vector<Vec3> position;                    // world, metres, shift not added
  std::vector<std::array<std::uint8_t, 3>> rgb;  // sRGB
  std::vector<float> intensity;                  // one per point, or empty: a scan has none
  std::vector<std::uint8_t> drawn;               // beside the proxy: no face or contour polygon stands for it
  std::size_t stray = 0;                         // left out
  std::size_t uncoloured = 0;                    // red
};
ExportPoints collect_points(stages::Renderer& renderer, bool photographs,
                            const std::vector<ScanProduct>& products,
                            const std::vector<std::optional<ScanRegistration>>& registrations,
                            const std::vector<ScanRemains>& remains, int tile);

// The points as one cloud in the coordinates of scene.crs: the scene's shift added.
Scan cloud_of(const ExportPoints& points, const io::SceneFile& scene);

// A scan in the same coordinates: its pose is the registered one, which E57 and others store without a
// scale: a scale other than 1 goes into the samples.
void set_registered_pose(Scan& scan, const Pose& world_from_scan, const io::SceneFile& scene);

}  // namespace hybrid::batch
