#include "stages/scan/noise_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing::noise_model_test {
namespace {

using stages::RangeNoise;

// Planar squares of 25 samples at many ranges and incidences, whose residuals follow the law; a share of them
// bends and scatters three times as much.
std::vector<SquareRecord> squares_with(const RangeNoise& law, int count, double bent_share) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::chi_squared_distribution<double> chi2(22);
  std::vector<SquareRecord> squares;
  for (int i = 0; i < count; ++i) {
    const double range = 1 + 19 * uniform(random), tangent = 8 * uniform(random) * uniform(random);
    const double cosine = 1 / std::hypot(1, tangent);
    const double scatter = uniform(random) < bent_share ? 3 : 1;
    SquareRecord square{};
    square.state = SQUARE_PLANAR;
    square.valid = square.inliers = 25;
    square.centroid[0] = static_cast<float>(range);
    square.offset = static_cast<float>(-range * cosine);
    square.rms = static_cast<float>(scatter * law.at(range, cosine) * cosine * std::sqrt(chi2(random) / 25));
    squares.push_back(square);
  }
  return squares;
}

void expect_same(const RangeNoise& found, const RangeNoise& law, double tolerance) {
  for (const double range : {2.0, 8.0, 18.0})
    for (const double cosine : {1.0, 0.7, 0.25}) {
      const double expected = law.at(range, cosine);
      EXPECT_NEAR(found.at(range, cosine), expected, tolerance * expected) << range << " m, " << cosine;
    }
}

}  // namespace

TEST(RangeNoise, the_law_is_recovered) {
  const RangeNoise law{0.0015, 0.0001, 0.0001, 0.00003};
  expect_same(stages::fit_range_noise(squares_with(law, 20000, 0), 0.002), law, 0.05);
}

TEST(RangeNoise, squares_that_bend_change_little) {
  const RangeNoise law{0.0015, 0.0001, 0.0001, 0.00003};
  expect_same(stages::fit_range_noise(squares_with(law, 20000, 0.2), 0.002), law, 0.1);
}

TEST(RangeNoise, constant_noise_stays_constant) {
  expect_same(stages::fit_range_noise(squares_with({0.002}, 20000, 0), 0.003), {0.002}, 0.05);
}

TEST(RangeNoise, too_few_squares_leave_the_given_noise) {
  expect_same(stages::fit_range_noise(squares_with({0.002}, 10, 0), 0.003), {0.003}, 1e-12);
  expect_same(stages::fit_range_noise({}, 0), {1e-4}, 1e-12);
}

TEST(RangeNoise, nothing_is_negative_or_not_finite) {
  auto squares = squares_with({0.002}, 5000, 0);
  for (auto& square : squares) square.rms = 0;
  const RangeNoise found = stages::fit_range_noise(squares, 0.002);
  for (const double range : {0.1, 1.0, 1000.0})
    for (const double cosine : {1.0, 0.05, 0.0}) {
      EXPECT_GE(found.at(range, cosine), 1e-4);
      EXPECT_TRUE(std::isfinite(found.at(range, cosine)));
    }
}

}  // namespace hybrid::testing::noise_model_test
