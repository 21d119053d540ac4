// The bound that normals are held against, where the answer is plain.
#include "score/measure/normals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace score_tests {
namespace {

using score::Vec3;

constexpr double kNoise_m = 0.002;
constexpr double kDegrees = 180 / 3.14159265358979323846;
const score::Plane kWall{{-1, 0, 0}, -5};

// Rays to the wall x = 5, a strip that is wider than high and off the foot point.
std::vector<Vec3> rays() {
  std::vector<Vec3> list;
  for (int row = 0; row < 8; ++row)
    for (int col = 0; col < 30; ++col) list.push_back(Vec3(1, 0.3 + 0.02 * col, 0.01 * row).normalized());
  return list;
}

struct Measured {
  score::LabelledGrid grid;
  score::TrueSamples truth;
};

Measured measure(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Measured result;
  for (const Vec3& ray : rays()) {
    const double range = 5 / ray.x(), measured = range + kNoise_m * normal(random);
    result.grid.point.push_back((measured * ray).cast<float>());
    result.grid.range_m.push_back(static_cast<float>(measured));
    result.truth.range_m.push_back(static_cast<float>(range));
    result.grid.source.push_back(static_cast<std::uint32_t>(result.grid.source.size()));
    result.grid.label.push_back(4);
  }
  return result;
}

// Least squares along the rays: range = 1 / (m . ray), linear in m to the first order.
Vec3 fitted_normal(const Measured& measured) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (const auto& p : measured.grid.point) {
    const Vec3 point = p.cast<double>();
    matrix += point.squaredNorm() * point * point.transpose();
    right += point.squaredNorm() * point;
  }
  return matrix.inverse() * right;
}

score::NormalScore scored(const Measured& measured, const Vec3& normal) {
  score::HooverScore hoover;
  hoover.region_of_plane[9] = 4;
  return score::score_normals(measured.grid, measured.truth, hoover, {{4, normal.normalized()}},
                              {{9, kWall}});
}

}  // namespace

TEST(NormalScore, a_fit_by_least_squares_reaches_the_bound) {
  std::mt19937 random(3);
  double squares = 0;
  constexpr int kDraws = 1000;
  const auto points = measure(random).grid.point;
  const double bound_deg = kNoise_m * score::direction_bound_rad(kWall, points) * kDegrees;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double angle = score::angle_between_deg(-fitted_normal(measure(random)), kWall.normal);
    squares += angle * angle / kDraws;
  }
  // The root mean square of 1000 draws of mostly one direction varies by 2.2 %; three times that.
  EXPECT_NEAR(std::sqrt(squares) / bound_deg, 1, 0.067);
}

TEST(NormalScore, counts_what_lies_beyond_three_bounds) {
  std::mt19937 random(5);
  const Measured measured = measure(random);
  const auto good = scored(measured, fitted_normal(measured));
  EXPECT_EQ(good.planes, 1);
  EXPECT_EQ(good.within_3, 1);
  const double turn = 6 * good.median_bound_deg / kDegrees;
  const auto bad = scored(measured, Vec3(-1, std::sin(turn), 0));
  EXPECT_EQ(bad.within_3, 0);
  EXPECT_NEAR(bad.largest, 6, 0.01);
  EXPECT_EQ(scored(measured, -kWall.normal).largest, 0);  // a plane has two normals
}

TEST(NormalScore, samples_that_fix_no_direction_are_not_compared) {
  std::mt19937 random(5);
  Measured measured = measure(random);
  for (std::size_t i = 30; i < measured.grid.label.size(); ++i) measured.grid.label[i] = 0;
  for (auto& point : measured.grid.point) point.z() = 0;  // one line
  EXPECT_TRUE(std::isinf(score::direction_bound_rad({{-1, 0, 0}, -5}, {{5, 1, 0}, {5, 2, 0}, {5, 3, 0}})));
  EXPECT_EQ(scored(measured, kWall.normal).planes, 0);
}

}  // namespace score_tests
