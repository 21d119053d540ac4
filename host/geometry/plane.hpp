#pragma once
#include "geometry/vectors.hpp"

namespace hybrid {

// Points x with normal . x = offset_m; the normal has length 1.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;

  double distance(const Vec3& point) const { return normal.dot(point) - offset_m; }
};

}  // namespace hybrid
