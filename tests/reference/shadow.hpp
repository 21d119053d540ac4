#pragma once
#include "geometry/vectors.hpp"
#include "shared/bvh_records.h"

namespace hybrid::testing {

// Distance along the unit direction at which the ray meets the triangle (two-sided) or enters the sphere,
// +inf when it does not. In double, by solving for the barycentric coordinates and by the residual of the
// centre.
double triangle_distance(const Vec3& origin, const Vec3& direction, const TriangleRecord& triangle);
double sphere_distance(const Vec3& origin, const Vec3& direction, const SphereRecord& sphere);

}  // namespace hybrid::testing
