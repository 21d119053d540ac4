#include "geometry/pose.hpp"

#include <cmath>

#include "core/error.hpp"

namespace hybrid {

std::array<double, 16> row_major(const Pose& pose) {
  const Mat3 linear = pose.scale * pose.rotation.toRotationMatrix();
  std::array<double, 16> matrix{};
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) matrix[static_cast<std::size_t>(4 * row + col)] = linear(row, col);
    matrix[static_cast<std::size_t>(4 * row + 3)] = pose.translation(row);
  }
  matrix[15] = 1;
  return matrix;
}

Pose pose_from_row_major(const std::array<double, 16>& matrix) {
  for (double value : matrix)
    if (!std::isfinite(value)) fail_input("pose: expected 16 finite numbers, found {}", value);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> full(matrix.data());
  if ((full.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-9)
    fail_input("pose: expected the last row 0 0 0 1 of a row-major 4x4 matrix, found {} {} {} {}", full(3, 0),
               full(3, 1), full(3, 2), full(3, 3));
  const Mat3 linear = full.topLeftCorner<3, 3>();
  const double determinant = linear.determinant();
  if (determinant <= 0)
    fail_input("pose: the rotation part has determinant {}: mirrored or singular", determinant);
  const double scale = std::cbrt(determinant);
  const Mat3 rotation = linear / scale;
  const double skew = (rotation * rotation.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (skew > 1e-3)
    fail_input("pose: the upper left 3x3 is not a rotation times a scale (off by {:.3g})", skew);
  return {scale, Eigen::Quaterniond(rotation).normalized(), full.topRightCorner<3, 1>()};
}

PoseDifference difference(const Pose& a, const Pose& b) {
  return {a.rotation.angularDistance(b.rotation), (a.translation - b.translation).norm()};
}

}  // namespace hybrid
