#include "stages/planes/bending.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::stages {
namespace {

constexpr double kCurvature = 0.36;  // a vault of 2.8 m
constexpr double kMinCurvature = 0.15;

// A strip, length x width (m), at `angle` to the axes, of a cylinder along it, with noise.
std::vector<Vec3> strip(double length, double width, double angle, double curvature, double noise_m,
                        int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> along(-length / 2, length / 2), across(-width / 2, width / 2);
  std::normal_distribution<double> noise(0, noise_m);
  std::vector<Vec3> heights;
  for (int k = 0; k < count; ++k) {
    const double u = along(random), v = across(random);
    heights.push_back({u * std::cos(angle) - v * std::sin(angle), u * std::sin(angle) + v * std::cos(angle),
                       0.5 * curvature * v * v + noise(random)});
  }
  return heights;
}

TEST(Bending, AStripOfACylinderBendsAtAnyAngle) {
  for (const double angle : {0.0, 0.3, 0.785, 1.2}) {
    const Bend bend = bend_of(strip(2, 0.2, angle, kCurvature, 0.0005, 4000), kMinCurvature);
    EXPECT_GT(bend.share, 0.3) << angle;
    EXPECT_NEAR(bend.curvature, kCurvature, 0.03) << angle;
  }
}

TEST(Bending, SaysHowWellItKnowsTheCurvature) {
  double squares = 0;
  constexpr int kTrials = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto heights = strip(1, 0.1, 0.7, kCurvature, 0, 1000);
    std::mt19937_64 random(static_cast<std::uint64_t>(trial));
    std::normal_distribution<double> noise(0, 0.0002);
    for (Vec3& height : heights) height.z() += noise(random);
    const Bend bend = bend_of(heights, 0);
    squares += std::pow((bend.curvature - kCurvature) / bend.sigma, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kTrials), 1, 0.3);
}

// A patch of a vault whose own bend is within its noise; what is around it, as centroids of squares.
TEST(Bending, APatchTooSmallToBendBendsLikeTheVaultAroundIt) {
  for (const double angle : {0.0, 0.7}) {
    const auto around = strip(1.5, 1.5, angle, kCurvature, 0.0002, 200);
    const auto patch = strip(0.12, 0.12, angle, kCurvature, 0.002, 3000);
    ASSERT_EQ(bend_of(patch, kMinCurvature).share, 0);
    ASSERT_GT(bend_of(around, kMinCurvature).share, 0.9);
    EXPECT_GT(bends_like(patch, around), 10) << angle;
    EXPECT_LT(bends_like(strip(0.12, 0.12, angle, 0, 0.002, 3000), around), -10) << angle;
    EXPECT_LT(std::abs(bends_like(strip(0.02, 0.02, angle, kCurvature, 0.002, 3000), around)), 1) << angle;
  }
}

TEST(Bending, BendsLikeNothingThatTellsNoBend) {
  const auto patch = strip(0.2, 0.2, 0, kCurvature, 0.001, 1000);
  EXPECT_EQ(bends_like(patch, strip(1.5, 1.5, 0, kCurvature, 0.0002, 20)), 0);
  EXPECT_EQ(bends_like(strip(0.2, 0.2, 0, kCurvature, 0.001, 20), strip(1.5, 1.5, 0, kCurvature, 0, 200)), 0);
  EXPECT_EQ(bends_like(patch, strip(1.5, 0, 0.3, 0, 0.001, 200)), 0);  // in a line
}

TEST(Bending, BendsWhereverTheSamplesCrowd) {
  auto heights = strip(2, 0.2, 0.4, kCurvature, 0.0005, 400);
  const auto dense = strip(0.1, 0.02, 0.4, kCurvature, 0.0005, 4000);
  heights.insert(heights.end(), dense.begin(), dense.end());
  const Bend bend = bend_of(heights, kMinCurvature);
  EXPECT_TRUE(bend.determined);
  EXPECT_GT(bend.share, 0.05);
  EXPECT_NEAR(bend.curvature, kCurvature, 0.1);
}

TEST(Bending, NoiseAndShallowBendsAreNone) {
  EXPECT_EQ(bend_of(strip(2, 0.2, 0.3, 0, 0.002, 4000), kMinCurvature).share, 0);
  EXPECT_EQ(bend_of(strip(2, 0.2, 0.3, 0.1, 0.0001, 4000), kMinCurvature).share, 0);
  EXPECT_EQ(bend_of(strip(2, 0.2, 0.3, kCurvature, 0.0005, 20), kMinCurvature).share, 0);
}

TEST(Bending, OneLineOrTwoTellNothing) {
  std::vector<Vec3> one, two;
  for (int k = 0; k < 200; ++k) {
    const double u = 0.005 * k - 0.5;
    one.push_back({u, 0, 0.5 * u * u});
    for (const double v : {-0.05, 0.05}) two.push_back({u, v, 0.5 * v * v + 1e-4 * std::sin(12.9898 * k)});
  }
  for (const auto* lines : {&one, &two}) {
    EXPECT_FALSE(bend_of(*lines, kMinCurvature).determined);
    EXPECT_EQ(bend_of(*lines, kMinCurvature).share, 0);
  }
}

// A flat strip whose outermost samples on one side lie beyond an edge seems to bend; without them it does
// not.
TEST(Bending, ARimDoesNotBendAPlane) {
  PlaneHeights heights;
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 0.0005);
  for (int row = 0; row < 200; ++row)
    for (int col = 0; col < 8; ++col)
      heights.add({0.01 * row, 0.01 * col, noise(random) + (col == 7 ? 0.003 : 0)},
                  {col<7, row<199, col> 0, row> 0});
  EXPECT_GE(bend_of(heights.all, kMinCurvature).share, kLeastShareBent);
  EXPECT_EQ(heights.bend(kMinCurvature).share, 0);
}

// A strip of 200 x 16 samples, 5 mm apart; its core lacks `deep` samples of every side. `shape`: height by
// column, metres.
template <typename Shape>
PlaneHeights dense_strip(unsigned seed, int deep, const Shape& shape) {
  PlaneHeights heights;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.0005);
  for (int row = 0; row < 200; ++row)
    for (int col = 0; col < 16; ++col) {
      const Vec3 height(0.005 * row, 0.005 * col, noise(random) + shape(col));
      heights.add(height, {col<15, row<199, col> 0, row> 0});
      if (std::min(col, row) >= deep && col < 16 - deep && row < 200 - deep) heights.core.push_back(height);
    }
  return heights;
}

// Where samples are dense, several rows beyond an edge are within the plane's noise. The core has none.
TEST(Bending, ADeepRimDoesNotBendAPlane) {
  const PlaneHeights heights = dense_strip(3, 3, [](int col) { return col > 12 ? 0.001 * (col - 12) : 0; });
  PlaneHeights without = heights;
  without.core.clear();
  EXPECT_GE(without.bend(kMinCurvature).share, kLeastShareBent);
  EXPECT_EQ(heights.bend(kMinCurvature).share, 0);
}

// A core too small to be sure of its bend does not clear a strip of a vault.
TEST(Bending, AVaultBendsThoughItsCoreIsSmall) {
  const PlaneHeights heights =
      dense_strip(4, 4, [](int col) { return 0.5 * std::pow(0.005 * (col - 7.5), 2) / 3; });
  EXPECT_EQ(bend_of(heights.core, kMinCurvature).share, 0);
  EXPECT_GE(heights.bend(kMinCurvature).share, kLeastShareBent);
}

}  // namespace
}  // namespace hybrid::stages
