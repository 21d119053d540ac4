#pragma once
#include <array>

#include "geometry/plane.hpp"

namespace hybrid::stages {

// Weighted first and second moments of points, mergeable without cancellation (Chan, Golub and LeVeque 1979).
// Sums are the same for the same order of merges: callers merge in a fixed order.
struct PlaneMoments {
  double weight = 0;
  Vec3 mean = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();  // sum of w (p - mean)(p - mean)^T

  void merge(const PlaneMoments& other);
};

// The plane of least orthogonal squares through moments, with what its covariance needs.
struct PlaneFit {
  Plane plane;  // normal towards the origin, which is the scanner
  Vec3 centroid = Vec3::Zero();
  std::array<Vec3, 2> axis = {Vec3::UnitX(), Vec3::UnitY()};  // in the plane; axis[0] the shorter extent
  std::array<double, 2> spread = {0, 0};                      // scatter along the axes, m2
  double weight = 0;
  double rms_m = 0;

  // (a, b, height): along the axes, from the centroid, and above the plane, m.
  Vec3 in_frame(const Vec3& point) const;
  // Standard deviation of the plane's offset at `point`, m.
  double offset_sigma_m(const Vec3& point) const;
  // Standard deviation of the normal's worse direction, rad.
  double normal_sigma_rad() const;
};

// Needs weight > 0; a degenerate set (a line, a point) gives some plane through it with a huge normal_sigma.
PlaneFit fit_plane(const PlaneMoments& moments);

// Turns the plane so that the origin (the scanner) lies on its normal's side.
void face_scanner(Plane& plane);

}  // namespace hybrid::stages
