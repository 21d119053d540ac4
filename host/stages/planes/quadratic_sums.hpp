#pragma once
#include <array>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid::stages {

// Where heights are, as (a, b, height) in m: means and mean products of a and b.
struct HeightExtent {
  Vec2 mean = Vec2::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
};
HeightExtent extent_of(const std::vector<Vec3>& heights);

// Coordinates in which heights are fitted: (a, b) from `mean`, turned, in units of `scale`.
struct HeightAxes {
  Vec2 mean;
  Eigen::Matrix2d turn;
  Vec2 scale = Vec2::Ones();
};
// The largest size of either coordinate, in units of the axes' scale.
Vec2 reach_of(const std::vector<Vec3>& heights, const HeightAxes& axes);

// The normal equations of height = sum of c_k (1, a, b, a^2, a b, b^2)_k by least squares, and the sum of the
// squared heights.
struct QuadraticSums {
  Eigen::Matrix<double, 6, 6> normal;
  Eigen::Matrix<double, 6, 1> right;
  double squares = 0;
};
QuadraticSums quadratic_sums(const std::vector<Vec3>& heights, const HeightAxes& axes);

}  // namespace hybrid::stages
