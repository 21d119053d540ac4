#pragma once
#include "geometry/camera.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid::batch {

// A camera that sees the whole model obliquely from above and outside, or from the opposite side.
Photograph overview_camera(const PolygonModel& model, int width, int height, bool from_behind = false);

}  // namespace hybrid::batch
