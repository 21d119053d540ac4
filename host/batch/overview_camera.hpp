#pragma once
#include <Eigen/Geometry>

#include "geometry/camera.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid::batch {

// A camera that sees the whole model obliquely from above and outside, or from the opposite side.
Photograph overview_camera(const PolygonModel& model, int width, int height, bool from_behind = false);
// The same of a box.
Photograph overview_camera(const Eigen::AlignedBox3d& box, int width, int height, bool from_behind = false);
// From far above, so that walls are lines, nearly; y is up in the picture.
Photograph plan_camera(const Eigen::AlignedBox3d& box, int width, int height);

}  // namespace hybrid::batch
