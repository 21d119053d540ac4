#include "stages/planes/ray_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing {
namespace {

// Samples of the plane x = 5 seen from the origin, a grid of `step` radians around (y, z) = (1, 0.5).
std::vector<Vec3> wall(double step, int side, double sigma_m, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<Vec3> points;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      const Vec3 ray = Vec3(1, 0.2 + step * c, 0.1 + step * r).normalized();
      points.push_back(ray * (5 / ray.x() + sigma_m * noise(random)));
    }
  return points;
}

}  // namespace

TEST(RayPlane, fits_exact_samples_however_close_together_they_are) {
  for (const double step : {1e-2, 1e-4}) {
    const auto points = wall(step, 5, 0, 1);
    stages::RayPlane plane(points[0]);
    for (const Vec3& p : points) plane.add(p);
    ASSERT_TRUE(plane.solve());
    EXPECT_LT((plane.plane().normal - Vec3(-1, 0, 0)).norm(), 1e-6) << step;
    EXPECT_NEAR(plane.plane().offset_m, -5, 1e-6);
    EXPECT_NEAR(plane.at(points[7] * 1.001, 1.001 * points[7].norm()).residual_m, 0.001 * points[7].norm(),
                1e-5);
    EXPECT_NEAR(plane.at(points[0], points[0].norm()).cosine, 5 / points[0].norm(), 1e-6);
  }
}

TEST(RayPlane, predicts_its_own_uncertainty) {
  // Beyond the samples, where the prediction is worth less than one measurement.
  const Vec3 far = Vec3(1, 0.2 + 0.01 * 10, 0.1) * 5;
  double squares = 0, variance = 0, chi2 = 0;
  for (std::uint32_t seed = 0; seed < 2000; ++seed) {
    const auto points = wall(0.01, 4, 0.002, seed);
    stages::RayPlane plane(points[0]);
    for (const Vec3& p : points) plane.add(p);
    ASSERT_TRUE(plane.solve());
    const double error = plane.at(far, far.norm()).residual_m / 0.002;
    squares += error * error / 2000;
    variance += plane.prediction_variance(far) / 2000;
    chi2 += plane.squares_m2() / (0.002 * 0.002) / 2000;
  }
  EXPECT_GT(variance, 1);
  EXPECT_NEAR(squares / variance, 1, 0.1);  // 2000 draws: 3 standard deviations are 0.095
  EXPECT_NEAR(chi2, 16 - 3, 0.4);           // 3 x sqrt(2 x 13 / 2000)
}

TEST(RayPlane, samples_in_line_fix_no_plane) {
  stages::RayPlane plane(Vec3(5, 0, 0));
  EXPECT_FALSE(plane.solve());
  for (int k = 0; k < 9; ++k) plane.add(Vec3(5, 0.1 * k, 0.05 * k));
  EXPECT_FALSE(plane.solve());
}

}  // namespace hybrid::testing
