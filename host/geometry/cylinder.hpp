#pragma once
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

}  // namespace hybrid
