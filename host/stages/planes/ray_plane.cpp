#include "stages/planes/ray_plane.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

constexpr double kThinnest = 1e-3;  // width over length: thinner samples are in line

}  // namespace

RayPlane::RayPlane(const Vec3& around) {
  const Vec3 across = around.unitOrthogonal();
  frame_.row(0) = around.normalized();
  frame_.row(1) = across;
  frame_.row(2) = around.normalized().cross(across);
}

void RayPlane::add(const Vec3& point) {
  const double weight = point.squaredNorm();
  const Vec3 turned = frame_ * point;
  samples_ += 1;
  const Vec3 weighted = weight * turned;
  for (int col = 0; col < 3; ++col)  // LDLT reads the lower triangle
    for (int row = col; row < 3; ++row) matrix_(row, col) += weighted[row] * turned[col];
  right_ += weighted;
  constant_ += weight;
}

bool RayPlane::solve() {
  if (samples_ < 3) return false;
  const Eigen::LDLT<Mat3> solver(matrix_);
  // The pivots go with the samples' extents: weight, length, width.
  const Vec3 pivots = solver.vectorD();
  if (!(pivots[2] > kThinnest * kThinnest * pivots[1])) return false;
  inverse_ = frame_.transpose() * solver.solve(Mat3::Identity()) * frame_;
  m_ = frame_.transpose() * solver.solve(right_);
  squares_m2_ = std::max(0.0, constant_ - right_.dot(solver.solve(right_)));
  length_ = m_.norm();
  inverse_length_ = 1 / length_;
  return m_.allFinite() && length_ > 0;
}

Plane RayPlane::plane() const {
  return {-m_ / length_, -1 / length_};
}

}  // namespace hybrid::stages
