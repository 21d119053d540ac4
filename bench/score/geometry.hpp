#pragma once
#include <Eigen/Dense>
#include <array>
#include <vector>

namespace score {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// x -> scale * rotation * x + translation.
struct Similarity {
  double scale = 1;
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();

  Vec3 operator*(const Vec3& point) const { return scale * (rotation * point) + translation; }
  Similarity operator*(const Similarity& other) const {
    return {scale * other.scale, rotation * other.rotation, *this * other.translation};
  }
  Similarity inverse() const {
    return {1 / scale, rotation.transpose(), rotation.transpose() * -translation / scale};
  }
};

// The similarity nearest to a row-major 4x4 matrix (polar decomposition). Throws InputError: numbers that are
// not finite, another last row than 0 0 0 1, a mirrored, singular or sheared matrix.
Similarity similarity_from_row_major(const std::array<double, 16>& matrix);

// Degrees, 0..180; exact for small angles too.
double angle_between_deg(const Vec3& a, const Vec3& b);
double rotation_angle_deg(const Mat3& rotation);

// normal . x = offset.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;
};

// Least squares through at least three points; the normal points to the side of the origin.
Plane fit_plane(const std::vector<Vec3>& points);

// Two axes that make a right-handed frame with the unit vector.
std::array<Vec3, 2> axes_across(const Vec3& unit);

}  // namespace score
