#pragma once
#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "geometry/cylinder.hpp"

namespace hybrid::stages {

// Points to fit a cylinder to, by coordinate; filled up to whole vectors with points that count 0.
class CylinderPoints {
 public:
  explicit CylinderPoints(const std::vector<Vec3>& points);

  // Gauss-Newton's normal equations of the points' distances from `at`, weighted by Tukey's biweight of
  // reach_m, in the axis' place and lean along `across` (2 each), the radius and the taper, at the middle.
  struct Sums {
    Eigen::Matrix<double, 6, 6> matrix;
    Eigen::Matrix<double, 6, 1> right;
    double squares = 0, weight = 0;
    std::size_t within = 0;
  };
  Sums sums(const Cylinder& at, const std::array<Vec3, 2>& across, double reach_m) const;

  // Where along the axis the points within reach begin and end, m; none: the first is larger.
  std::pair<double, double> extent(const Cylinder& at, double reach_m) const;

 private:
  std::vector<double> x_, y_, z_, counts_;
};

}  // namespace hybrid::stages
