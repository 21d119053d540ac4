#include "stages/planes/tangent_rims.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing::tangent_rims_test {
namespace {

constexpr int kRows = 96, kCols = 160, kSpring = 50;  // rows above kSpring are the vault's
constexpr double kSigma_m = 0.002, kSpacing_m = 0.03;

struct Sampling {
  int rows = kRows, cols = kCols, spring = kSpring;
  double spacing_m = kSpacing_m;
};

// A wall 5 m ahead, seen head on, and what stands on it from row kSpring upwards: `height` of the metres
// above that row, towards the scanner. Samples within three sigmas and 5 mm of the wall carry its label.
template <typename Height>
struct Wall {
  explicit Wall(const Height& height, unsigned seed = 1, const Sampling& of = {})
      : image(make_range_image(of.rows, of.cols)), spring(of.spring) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kSigma_m);
    labels.assign(image.count(), 0);
    for (int row = 0; row < of.rows; ++row)
      image.elevation_rad[static_cast<std::size_t>(row)] = std::atan(of.spacing_m * (of.rows / 2 - row) / 5);
    for (int col = 0; col < of.cols; ++col)
      image.azimuth_rad[static_cast<std::size_t>(col)] = std::atan(of.spacing_m * (col - of.cols / 2) / 5);
    for (int row = 0; row < of.rows; ++row)
      for (int col = 0; col < of.cols; ++col) {
        const std::size_t i = image.index(row, col);
        const double over = height(of.spacing_m * std::max(0, of.spring - row)) + noise(random);
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(5 - over);
        image.y[i] = static_cast<float>(of.spacing_m * (col - of.cols / 2));
        image.z[i] = static_cast<float>(of.spacing_m * (of.rows / 2 - row));
        labels[i] = std::abs(over) <= 3 * kSigma_m + 0.005;
      }
    regions.regions.resize(1);
  }
  std::vector<std::uint32_t> trim(double excess = 1) {
    return stages::trim_tangent_rims(image, stages::RangeNoise{kSigma_m}, excess, labels, planes, regions, 7);
  }
  // With the wall's label, of the vault's rows and of the wall's.
  std::pair<int, int> labelled() const {
    std::pair<int, int> count;
    for (int row = 0; row < image.rows; ++row)
      for (int col = 0; col < image.cols; ++col)
        (row < spring ? count.first : count.second) += labels[image.index(row, col)] == 1;
    return count;
  }

  RangeImage image;
  int spring;
  std::vector<std::uint32_t> labels;
  std::vector<Plane> planes = {{-Vec3::UnitX(), -5}};
  stages::PlaneRegions regions;
};

double vault(double above_m) {
  return 3.0 - std::sqrt(std::max(0.0, 9.0 - above_m * above_m));
}

}  // namespace

TEST(TangentRims, a_vault_takes_what_is_its_own) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Wall wall(vault, seed);
    const auto before = wall.labelled();
    ASSERT_GT(before.first, 7 * kCols);  // nearly eight rows of the vault are within the wall's noise
    EXPECT_EQ(wall.trim().back(), 1u);
    const auto after = wall.labelled();
    EXPECT_LT(after.first, before.first / 3);
    EXPECT_GT(after.second, before.second - 2 * kCols);
  }
}

// On a fine grid the vault rises over a hundred rows before it leaves the wall's noise.
TEST(TangentRims, a_fine_grid_is_looked_at_over_the_same_angle) {
  Wall wall(vault, 1, {480, 480, 250, 0.00225});
  const auto before = wall.labelled();
  ASSERT_GT(before.first, 100 * 480);
  wall.trim();
  const auto after = wall.labelled();
  EXPECT_LT(after.first, before.first / 2);
  EXPECT_GT(after.second, before.second - 10 * 480);
}

// Samples that no plane took make rims of their own below the vault's, in the same tiles.
TEST(TangentRims, other_rims_near_by_do_not_hide_a_vault) {
  Wall wall(vault);
  for (int row = kSpring + 6; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col)
      if (col % 16 < 4) wall.labels[wall.image.index(row, col)] = 0;
  const auto before = wall.labelled();
  ASSERT_GT(before.first, 7 * kCols);
  wall.trim();
  const auto after = wall.labelled();
  EXPECT_LT(after.first, before.first / 3);
  EXPECT_GT(after.second, before.second - 2 * kCols);
}

// A soffit or another wall begins at a crease, however shallow; nothing is taken from either.
TEST(TangentRims, a_crease_is_no_curve) {
  for (const double slope : {0.05, 0.3, 0.9}) {
    Wall wall([&](double above_m) { return slope * above_m; });
    const auto before = wall.labelled();
    wall.trim();
    EXPECT_EQ(wall.labelled(), before) << slope;
  }
}

TEST(TangentRims, a_wall_that_ends_is_left_alone) {
  Wall wall([](double above_m) { return above_m > 0 ? 1.0 : 0.0; });
  const auto before = wall.labels;
  EXPECT_TRUE(wall.trim().empty());
  EXPECT_EQ(wall.labels, before);
}

// Where means scatter twenty times as much as the noise of samples explains, the curve proves nothing.
TEST(TangentRims, noise_that_samples_share_proves_no_curve) {
  Wall wall(vault);
  const auto before = wall.labels;
  EXPECT_TRUE(wall.trim(20).empty());
  EXPECT_EQ(wall.labels, before);
}

}  // namespace hybrid::testing::tangent_rims_test
