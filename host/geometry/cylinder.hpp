#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/vectors.hpp"

namespace hybrid {

// A column or a pipe as one scan saw it from outside, or a barrel vault from inside: round about its axis, a
// little conical where it tapers.
struct Cylinder {
  std::uint32_t id = 0;       // from 1, most samples first
  Vec3 foot = Vec3::Zero();   // on the axis, where what was seen begins; scan frame, metres
  Vec3 axis = Vec3::UnitZ();  // unit, from foot to head, never downwards
  double length_m = 0;        // along the axis
  double radius_m = 0;        // half-way up
  double taper = 0;           // by how much the radius grows along the axis, metres per metre
  double rms_m = 0;           // of its samples' distances
  double sigma_radius_m = 0;  // standard deviation, of chance alone
  double arc_deg = 0;         // of the circumference that was seen
  std::int64_t samples = 0;   // measured, on it, and on no plane
  bool inside = false;        // seen from inside: a vault

  double along(const Vec3& point) const { return axis.dot(point - foot); }
  double radius_at(double along_m) const { return radius_m + taper * (along_m - 0.5 * length_m); }
  // From the axis outwards, perpendicular to it.
  Vec3 outwards(const Vec3& point) const { return point - foot - along(point) * axis; }
  // Positive outside. Measured perpendicular to the axis, whatever the taper.
  double distance(const Vec3& point) const { return outwards(point).norm() - radius_at(along(point)); }
};

// Whether the middle of one lies within the other, near its axis: found twice on one surface.
inline bool is_same(const Cylinder& a, const Cylinder& b) {
  const Vec3 middle = a.foot + 0.5 * a.length_m * a.axis;
  return a.inside == b.inside && b.along(middle) >= 0 && b.along(middle) <= b.length_m &&
         b.outwards(middle).norm() < 0.5 * std::min(a.radius_m, b.radius_m);
}

// Whether two columns may be of one design: as thick, as upright.
inline bool is_alike(const Cylinder& a, const Cylinder& b) {
  constexpr double kThicker = 0.05, kParallel = 0.9994;  // of the radius; cosine of 2 degrees
  return !a.inside && !b.inside && std::abs(a.radius_m - b.radius_m) <= kThicker * a.radius_m &&
         a.axis.dot(b.axis) >= kParallel;
}

}  // namespace hybrid
