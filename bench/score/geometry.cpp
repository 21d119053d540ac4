#include "score/geometry.hpp"

#include <cmath>
#include <numbers>

#include "score/error.hpp"

namespace score {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kLargestShear = 1e-3;  // relative difference of the singular values

}  // namespace

Similarity similarity_from_row_major(const std::array<double, 16>& matrix) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> full(matrix.data());
  if (!full.allFinite()) bad_input("expected 16 finite numbers, found others");
  if ((full.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-9)
    bad_input("expected a row-major 4x4 matrix that ends in 0 0 0 1, found {} {} {} {}", full(3, 0),
              full(3, 1), full(3, 2), full(3, 3));
  const Mat3 linear = full.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Mat3> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 stretch = svd.singularValues();
  const Mat3 rotation = svd.matrixU() * svd.matrixV().transpose();
  if (!(stretch[2] > 0) || rotation.determinant() < 0)
    bad_input("expected a rotation times a scale, found a mirrored or singular matrix");
  if (stretch[0] - stretch[2] > kLargestShear * stretch[0])
    bad_input("expected a rotation times a scale, found one that stretches by {:.6g} to {:.6g}", stretch[2],
              stretch[0]);
  return {stretch.mean(), rotation, full.topRightCorner<3, 1>()};
}

double angle_between_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees;
}

double rotation_angle_deg(const Mat3& r) {
  const Vec3 twice_sine(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(twice_sine.norm(), r.trace() - 1) * kDegrees;
}

Plane fit_plane(const std::vector<Vec3>& points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
  Plane plane;
  plane.normal = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvectors().col(0);
  if (plane.normal.dot(mean) > 0) plane.normal = -plane.normal;
  plane.offset_m = plane.normal.dot(mean);
  return plane;
}

std::array<Vec3, 2> axes_across(const Vec3& unit) {
  const Vec3 u = unit.unitOrthogonal();
  return {u, unit.cross(u)};
}

}  // namespace score
