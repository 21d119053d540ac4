#pragma once
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/polygon_model.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::io {

// [scene] shift, as other programs' global shift: what is given in the coordinates of a map loses it, what is
// near the origin already stays. Of shifts below this nobody can tell which of both a coordinate is: they are
// only put back into outputs.
constexpr double kLeastMapShift_m = 1000;

// Whether the point is of the map: nearer to the shift than to the origin.
bool is_on_map(const Vec3& point, const Vec3& shift);
// The point without the shift, if it is of the map.
Vec3 off_map(const Vec3& point, const Vec3& shift);

// All that the scene file itself says in the model's frame: landmarks, views, paths, holes, clips and
// world_from_photographs. Poses of scans are taken when they are in the scan's frame (in_scan_frame).
void take_off_shift(SceneFile& scene);

// The model as a whole, by the middle of its box. Returns whether it was of the map.
bool take_off_shift(const Vec3& shift, PolygonModel& model);

// Each by where it was taken.
void take_off_shift(const Vec3& shift, std::vector<Photograph>& cameras);

}  // namespace hybrid::io
