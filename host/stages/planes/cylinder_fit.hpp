#pragma once
#include <optional>
#include <vector>

#include "geometry/cylinder.hpp"

namespace hybrid::stages {

struct OrientedPoint {
  Vec3 point, normal;  // the normal towards the scanner
};

// The cylinder that oriented points of a curved surface suggest: its axis is what their normals vary least
// along, axis and radius those for which point - radius * normal is nearest to one line, by linear least
// squares; seen from inside when the normals point to the axis. None when the normals turn by too little to
// tell. Length and taper are left open.
std::optional<Cylinder> cylinder_through(const std::vector<OrientedPoint>& points);

// Least squares of the points' distances by axis, radius and taper (Gauss-Newton, Tukey's weights, which
// leave out what is farther than reach_m), from `start`. The taper is held near 0 by a prior of
// kTaperSigma, which lean and taper of an axis that is seen from one side need. Sets foot and length to what
// the points within reach take of the axis, rms and sigma of the radius. None when it does not converge or
// fewer than 10 points are within reach.
std::optional<Cylinder> fit_cylinder(const std::vector<Vec3>& points, const Cylinder& start, double reach_m);

inline constexpr double kTaperSigma = 0.02;

}  // namespace hybrid::stages
