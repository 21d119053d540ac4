#include "stages/planes/plane_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hybrid::testing::plane_steps_test {
namespace {

constexpr int kRows = 160, kCols = 320, kSquare = 8;
constexpr double kSigma_m = 0.002;
constexpr std::int64_t kLeast = 48;

// A wall 5 m ahead, seen head on, all of it labelled 1: `height` (row, column) metres towards the scanner,
// and noise.
struct Wall {
  template <typename Height>
  explicit Wall(const Height& height, unsigned seed = 1) : image(make_range_image(kRows, kCols)) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kSigma_m);
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col) {
        const std::size_t i = image.index(row, col);
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(5 - height(row, col) + noise(random));
        image.y[i] = 0.01f * static_cast<float>(col - kCols / 2);
        image.z[i] = 0.01f * static_cast<float>(kRows / 2 - row);
      }
    labels.assign(image.count(), 1);
    regions.regions.resize(1);
    squares.square = kSquare;
    squares.rows = (kRows + kSquare - 1) / kSquare;
    squares.cols = (kCols + kSquare - 1) / kSquare;
  }
  bool split() {
    const auto before = labels;
    const auto changed =
        stages::split_steps(image, stages::SquareGrid(image, squares), kSquare, stages::RangeNoise{kSigma_m},
                            {kLeast, 0.005}, labels, planes, regions)
            .labels;
    EXPECT_EQ(changed.empty(), labels == before);
    return !changed.empty();
  }
  // Samples with this label among those that `inside` names, and outside of them.
  template <typename Inside>
  std::pair<int, int> samples(std::uint32_t label, const Inside& inside) const {
    std::pair<int, int> result;
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col)
        if (labels[image.index(row, col)] == label) (inside(row, col) ? result.first : result.second) += 1;
    return result;
  }

  RangeImage image;
  stages::SquarePlanes squares;
  std::vector<std::uint32_t> labels;
  std::vector<Plane> planes = {{-Vec3::UnitX(), -5}};
  stages::PlaneRegions regions;
};

bool on_rail(int row, int col) {
  return row >= 20 && row < 26 && col >= 30 && col < 130;
}

}  // namespace

TEST(PlaneSteps, a_rail_hardly_prouder_than_the_noise_is_a_plane_of_its_own) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Wall wall([](int row, int col) { return on_rail(row, col) ? 0.0025 : 0; }, seed);
    ASSERT_TRUE(wall.split());
    ASSERT_EQ(wall.planes.size(), 2u);
    EXPECT_TRUE(wall.regions.regions[1].small);
    EXPECT_FALSE(wall.regions.regions[1].squares.empty());
    EXPECT_NEAR(wall.planes[1].offset_m, -4.9975, 0.0003);
    EXPECT_EQ(wall.planes[1].normal, wall.planes[0].normal);
    const auto [right, wrong] = wall.samples(2, on_rail);  // of 600
    EXPECT_GT(right, 500);
    EXPECT_LT(wrong, 60);
  }
}

TEST(PlaneSteps, the_pieces_of_a_rail_behind_a_post_are_one_plane) {
  Wall wall([](int row, int col) { return on_rail(row, col) ? 0.0025 : 0; });
  for (int row = 0; row < kRows; ++row)
    for (int col = 70; col < 90; ++col) wall.labels[wall.image.index(row, col)] = 0;
  ASSERT_TRUE(wall.split());
  EXPECT_EQ(wall.planes.size(), 2u);
  EXPECT_GT(wall.samples(2, on_rail).first, 400);  // of 480
}

// Mixed samples along its far edge, say: a dozen of some three hundred.
TEST(PlaneSteps, a_few_samples_deep_in_a_rail_do_not_refute_it) {
  const auto rail = [](int row, int col) { return row >= 23 && row < 26 && col >= 30 && col < 130; };
  const auto odd = [](int row, int col) { return row == 22 && col >= 60 && col < 72; };
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Wall wall([&](int row, int col) { return odd(row, col) ? 0.0055 : rail(row, col) ? 0.0025 : 0; }, seed);
    for (int row = 0; row < 23; ++row)
      for (int col = 0; col < kCols; ++col)
        if (!odd(row, col)) {
          wall.labels[wall.image.index(row, col)] = 0;
          wall.image.mask[wall.image.index(row, col)] = kEmpty;
        }
    ASSERT_TRUE(wall.split());
    ASSERT_EQ(wall.planes.size(), 2u);
    EXPECT_NEAR(wall.planes[1].offset_m, -4.9975, 0.0007);  // the dozen pull by 0.1 mm
    EXPECT_GT(wall.samples(2, rail).first, 220);            // of 300
  }
}

TEST(PlaneSteps, a_plain_wall_is_left_alone) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Wall wall([](int, int) { return 0.0; }, seed);
    EXPECT_FALSE(wall.split());
    EXPECT_EQ(wall.planes.size(), 1u);
    EXPECT_EQ(wall.labels, std::vector<std::uint32_t>(wall.image.count(), 1));
  }
}

// A wave rises gradually: where it is high is no part of its own.
TEST(PlaneSteps, a_wavy_wall_is_left_alone) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Wall wall([](int row, int col) { return 0.003 * std::sin(0.1 * row) * std::sin(0.08 * col); }, seed);
    EXPECT_FALSE(wall.split()) << seed;
  }
}

// Ranges in steps of 1 mm make bands of a slanted wall; those are no planes, whatever the noise.
TEST(PlaneSteps, bands_of_quantised_ranges_are_left_alone) {
  for (const double quantum_m : {0.001, 0.004}) {
    Wall wall([](int, int) { return 0.0; });
    for (int row = 0; row < kRows; ++row)
      for (int col = 0; col < kCols; ++col) {
        const double slant = 0.0002 * col;
        wall.image.x[wall.image.index(row, col)] =
            static_cast<float>(5 - std::round(slant / quantum_m) * quantum_m + slant);
      }
    EXPECT_FALSE(wall.split()) << quantum_m;
  }
}

// Noise that columns share, as some scanners make it, is no sheaf of strips.
TEST(PlaneSteps, stripes_all_over_a_scan_are_noise) {
  std::mt19937 random(7);
  std::normal_distribution<double> shared(0, kSigma_m);
  std::vector<double> of_col(kCols);
  for (int col = 0; col < kCols; ++col)
    of_col[static_cast<std::size_t>(col)] =
        col % 4 == 0 ? shared(random) : of_col[static_cast<std::size_t>(col - 1)];
  Wall wall([&](int, int col) { return of_col[static_cast<std::size_t>(col)]; });
  EXPECT_FALSE(wall.split());
}

// A vault of 4 m radius leaves the wall along its tangent: its first samples are within the wall's noise.
TEST(PlaneSteps, a_vault_that_begins_on_a_wall_keeps_its_samples) {
  Wall wall([](int row, int) {
    const double above = 0.01 * std::max(0, 30 - row);
    return above * above / (2 * 4.0);
  });
  // What label_samples leaves: the rows whose height is within three sigmas.
  for (int row = 0; row < 9; ++row)
    for (int col = 0; col < kCols; ++col) wall.labels[wall.image.index(row, col)] = 0;
  const auto above = [](int row, int) { return row < 30; };
  const auto before = wall.samples(1, above).first;
  ASSERT_TRUE(wall.split());
  EXPECT_EQ(wall.planes.size(), 1u);
  EXPECT_LT(wall.samples(1, above).first, before * 3 / 4);
  EXPECT_LT(wall.samples(0, above).second, 60);  // of 3,200 in the ten rows below it
}

TEST(PlaneSteps, an_image_without_labels_stays) {
  Wall wall([](int, int) { return 0.0; });
  wall.labels.assign(wall.labels.size(), 0);
  EXPECT_FALSE(wall.split());
}

}  // namespace hybrid::testing::plane_steps_test
