#include "stages/planes/refuted_planes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing::refuted_planes_test {
namespace {

constexpr int kSide = 20;
constexpr double kSigma_m = 0.001;

// A wall 5 m ahead, all of it labelled 1, a small plane: `height` (row, column) metres beyond the plane along
// x.
struct Wall {
  template <typename Height>
  explicit Wall(const Height& height) : image(make_range_image(kSide, kSide)) {
    for (int row = 0; row < kSide; ++row)
      for (int col = 0; col < kSide; ++col) {
        const std::size_t i = image.index(row, col);
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(5 + height(row, col));
        image.y[i] = 0.01f * static_cast<float>(col - kSide / 2);
        image.z[i] = 0.01f * static_cast<float>(kSide / 2 - row);
      }
    regions.regions.resize(2);
    regions.regions[0].small = true;
    presence = {{0, 1}, {0, 2}, {1, 1}};
  }
  bool drop(std::int64_t least) {
    return stages::drop_refuted_planes(image, stages::RangeNoise{kSigma_m}, {{-Vec3::UnitX(), -5}, {}},
                                       std::vector<std::uint32_t>(image.count(), 1), {least, 0.15}, regions,
                                       presence);
  }

  RangeImage image;
  stages::PlaneRegions regions;
  stages::SquarePresence presence;
};

double relief(int row, int col) {
  return 10 * kSigma_m * std::sin(0.5 * row) * std::sin(0.5 * col);
}

}  // namespace

TEST(RefutedPlanes, a_small_plane_with_enough_samples_in_its_noise_stays) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, kSigma_m);
  Wall wall([&](int, int) { return noise(random); });
  EXPECT_FALSE(wall.drop(kSide * kSide));
  EXPECT_TRUE(wall.regions.regions[0].small);
  EXPECT_EQ(wall.presence.size(), 3u);
}

TEST(RefutedPlanes, a_small_plane_without_enough_samples_goes) {
  Wall wall([](int, int) { return 0.0; });
  EXPECT_TRUE(wall.drop(kSide * kSide + 1));
  EXPECT_FALSE(wall.regions.regions[0].small);
  EXPECT_EQ(wall.presence, (stages::SquarePresence{{0, 2}}));
}

TEST(RefutedPlanes, relief_goes_and_noise_of_its_size_stays) {
  Wall carved(relief);
  EXPECT_TRUE(carved.drop(48));
  EXPECT_FALSE(carved.regions.regions[0].small);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 3 * kSigma_m);
  Wall rough([&](int, int) { return noise(random); });
  EXPECT_FALSE(rough.drop(48));
  EXPECT_TRUE(rough.regions.regions[0].small);
}

// A bend of a metre's radius leaves the noise by less than twice: no relief, and no plane.
TEST(RefutedPlanes, a_bend_goes_and_one_of_the_rim_alone_stays) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, kSigma_m);
  const auto bent = [](double from_m) { return from_m * from_m / 2; };
  Wall lamp([&](int row, int) { return bent(0.01 * (row - kSide / 2)) + noise(random); });
  EXPECT_TRUE(lamp.drop(48));
  EXPECT_FALSE(lamp.regions.regions[0].small);
  Wall rim([&](int row, int) { return (row < 2 ? 0.006 : 0) + noise(random); });
  EXPECT_FALSE(rim.drop(48));
  EXPECT_TRUE(rim.regions.regions[0].small);
}

TEST(RefutedPlanes, regions_of_squares_are_not_asked) {
  Wall wall(relief);
  wall.regions.regions[0].small = false;
  EXPECT_FALSE(wall.drop(48));
  EXPECT_EQ(wall.presence.size(), 3u);
}

}  // namespace hybrid::testing::refuted_planes_test
