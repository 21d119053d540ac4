#include "stages/planes/cylinder_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hybrid::testing::cylinder_sums_test {
namespace {

// Points about a leaning column, some out of reach, one on its axis; as many as fill no whole vectors.
std::vector<Vec3> points_about(const Cylinder& column, const std::array<Vec3, 2>& across) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, 0.004);
  std::vector<Vec3> points = {column.foot + 0.3 * column.axis};
  while (points.size() < 45) {
    const double along = column.length_m * unit(random), turn = 3 * unit(random);
    const double radius = column.radius_at(along) + noise(random);
    points.push_back(column.foot + along * column.axis +
                     radius * (std::cos(turn) * across[0] + std::sin(turn) * across[1]));
  }
  return points;
}

// One point after the other, as the header says it.
TEST(CylinderSums, of_vectors_are_those_of_single_points) {
  Cylinder column;
  column.foot = Vec3(4, -1, -1.5);
  column.axis = Vec3(0.05, -0.02, 1).normalized();
  column.length_m = 2.5;
  column.radius_m = 0.3;
  column.taper = -0.01;
  const Vec3 a = column.axis.unitOrthogonal();
  const std::array<Vec3, 2> across = {a, column.axis.cross(a)};
  const double reach = 0.008;
  const auto points = points_about(column, across);

  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  double squares = 0, weights = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  std::size_t within = 0;
  for (const Vec3& point : points) {
    const double r = column.distance(point), t = column.along(point) - 0.5 * column.length_m;
    if (std::abs(r) >= reach) continue;
    const double weight = std::pow(1 - r * r / (reach * reach), 2);
    const Vec3 out = column.outwards(point).normalized();
    Eigen::Matrix<double, 6, 1> row;
    row << -out.dot(across[0]), -out.dot(across[1]), -t * out.dot(across[0]), -t * out.dot(across[1]), -1, -t;
    matrix += weight * row * row.transpose();
    right -= weight * r * row;
    squares += weight * r * r;
    weights += weight;
    within += 1;
    low = std::min(low, column.along(point));
    high = std::max(high, column.along(point));
  }
  ASSERT_GT(within, 30U);
  ASSERT_LT(within, points.size() - 1);

  const stages::CylinderPoints of(points);
  const auto sums = of.sums(column, across, reach);
  EXPECT_EQ(sums.within, within);
  EXPECT_NEAR(sums.squares, squares, 1e-12 * weights);
  EXPECT_NEAR(sums.weight, weights, 1e-12 * weights);
  EXPECT_LT((sums.matrix - matrix).norm(), 1e-12 * matrix.norm());
  EXPECT_LT((sums.right - right).norm(), 1e-12 * weights);
  const auto [first, last] = of.extent(column, reach);
  EXPECT_NEAR(first, low, 1e-14);
  EXPECT_NEAR(last, high, 1e-14);
}

TEST(CylinderSums, of_no_points_within_reach_are_nothing) {
  Cylinder column;
  column.radius_m = 1;
  const std::array<Vec3, 2> across = {Vec3::UnitX(), Vec3::UnitY()};
  for (const auto& points : {std::vector<Vec3>{}, std::vector<Vec3>(3, Vec3(5, 0, 0))}) {
    const stages::CylinderPoints of(points);
    const auto sums = of.sums(column, across, 0.1);
    EXPECT_EQ(sums.within, 0U);
    EXPECT_EQ(sums.weight, 0);
    EXPECT_EQ(sums.matrix.norm(), 0);
    const auto [first, last] = of.extent(column, 0.1);
    EXPECT_GT(first, last);
  }
}

}  // namespace
}  // namespace hybrid::testing::cylinder_sums_test
