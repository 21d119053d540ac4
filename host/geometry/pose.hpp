#pragma once
#include <array>

#include "geometry/vectors.hpp"

namespace hybrid {

// A similarity x -> scale * rotation * x + translation. Named target_from_source: world_from_scan,
// cam_from_world.
struct Pose {
  double scale = 1;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 translation = Vec3::Zero();

  Vec3 operator*(const Vec3& point) const { return scale * (rotation * point) + translation; }
  Pose operator*(const Pose& inner) const {
    return {scale * inner.scale, (rotation * inner.rotation).normalized(), *this * inner.translation};
  }
  Pose inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {1 / scale, back, -(back * translation) / scale};
  }
  Vec3 rotate(const Vec3& direction) const { return rotation * direction; }
};

// 4x4, row-major, scale included, last row 0 0 0 1: the form of scene files and pose.json.
std::array<double, 16> row_major(const Pose& pose);
// Throws ErrorKind::input when `matrix` is not a similarity: non-finite, a wrong last row, sheared, mirrored.
Pose pose_from_row_major(const std::array<double, 16>& matrix);

// How far apart two poses are: rotation angle and distance of translations.
struct PoseDifference {
  double angle_rad = 0;
  double distance_m = 0;
  bool within(double most_m, double most_rad) const { return distance_m < most_m && angle_rad < most_rad; }
};
PoseDifference difference(const Pose& a, const Pose& b);

}  // namespace hybrid
