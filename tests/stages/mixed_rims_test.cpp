#include "stages/mixed_rims.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

namespace hybrid::testing {
namespace {

constexpr int kSide = 60, kEdge = 30;  // columns; the wall ends before kEdge
constexpr double kSigma_m = 0.001, kWall_m = 5;

// A wall (label 1) 5 m ahead up to column kEdge, another surface `behind_m` beyond it from there on;
// neighbours lie `spacing_m` apart. `height` (row, col): metres beyond the wall that its samples are off.
struct Corner {
  double behind_m = 0.5, spacing_m = 0.005;
  std::function<double(int, int)> height = [](int, int) { return 0.0; };

  RangeImage image = make_range_image(kSide, kSide);
  std::vector<std::uint32_t> labels = std::vector<std::uint32_t>(image.count());
  std::vector<Plane> planes = {{-Vec3::UnitX(), -kWall_m}};
  stages::PlaneRegions regions;

  std::vector<std::int64_t> trim() {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, kSigma_m);
    regions.regions.resize(planes.size());
    for (int row = 0; row < kSide; ++row) {
      image.elevation_rad[static_cast<std::size_t>(row)] = -spacing_m / kWall_m * row;
      for (int col = 0; col < kSide; ++col) {
        image.azimuth_rad[static_cast<std::size_t>(col)] = spacing_m / kWall_m * col;
        const std::size_t i = image.index(row, col);
        const bool wall = col < kEdge;
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(kWall_m + noise(random) + (wall ? height(row, col) : behind_m));
        image.y[i] = static_cast<float>(spacing_m * (col - kSide / 2));
        image.z[i] = static_cast<float>(spacing_m * (kSide / 2 - row));
        if (wall && labels[i] == 0) labels[i] = 1;
      }
    }
    return stages::trim_mixed_rims(image, stages::RangeNoise{kSigma_m}, planes, regions, labels);
  }
  std::int64_t left_in_column(int col) const {
    std::int64_t count = 0;
    for (int row = 0; row < kSide; ++row) count += labels[image.index(row, col)] == 1;
    return count;
  }
};

double mixed_at_edge(int, int col) {
  return col >= kEdge - 2 ? 2 * kSigma_m : 0;
}

}  // namespace

TEST(MixedRims, rows_that_lean_to_the_surface_behind_lose_their_label) {
  Corner corner;
  corner.height = mixed_at_edge;
  const auto lost = corner.trim();
  EXPECT_LE(corner.left_in_column(kEdge - 1), kSide / 20);
  EXPECT_LE(corner.left_in_column(kEdge - 2), kSide / 20);
  EXPECT_GE(corner.left_in_column(kEdge - 3), kSide - kSide / 20);
  EXPECT_EQ(lost[1], kSide * kEdge - std::count(corner.labels.begin(), corner.labels.end(), 1u));
}

TEST(MixedRims, a_clean_edge_keeps_its_samples) {
  Corner corner;
  EXPECT_LE(corner.trim()[1], kSide / 20);
}

TEST(MixedRims, rows_that_lean_to_the_other_side_are_no_mixtures) {
  Corner corner;
  corner.height = [](int row, int col) { return -mixed_at_edge(row, col); };
  EXPECT_EQ(corner.trim()[1], 0);
}

TEST(MixedRims, without_a_jump_nothing_is_mixed) {
  Corner corner;
  corner.height = mixed_at_edge;
  corner.behind_m = 0.008;
  EXPECT_EQ(corner.trim()[1], 0);
}

TEST(MixedRims, samples_farther_apart_than_a_beam_is_wide_are_left_alone) {
  Corner corner;
  corner.height = mixed_at_edge;
  corner.spacing_m = 0.01;
  EXPECT_EQ(corner.trim()[1], 0);
}

TEST(MixedRims, a_strip_that_is_all_border_is_no_plane) {
  for (const bool small : {true, false}) {
    Corner corner;
    corner.planes.push_back({-Vec3::UnitX(), -kWall_m});
    corner.regions.regions.resize(2);
    corner.regions.regions[1].small = small;
    for (int row = 0; row < kSide; ++row)
      for (const int col : {10, 11}) corner.labels[corner.image.index(row, col)] = 2;
    EXPECT_EQ(corner.trim()[2], small ? 2 * kSide : 0);
    EXPECT_EQ(std::count(corner.labels.begin(), corner.labels.end(), 2u), small ? 0 : 2 * kSide);
  }
}

TEST(MixedRims, a_few_samples_seen_from_the_side_are_no_plane_and_many_are) {
  for (const int width : {4, 12}) {
    Corner corner;
    // Holds the rays almost: 88 degrees from the wall's normal, through the middle of its strip.
    const Vec3 normal(-std::cos(1.536), std::sin(1.536), 0);
    corner.planes.push_back({normal, normal.dot(Vec3(kWall_m, 0.005 * (8 - kSide / 2.0), 0))});
    corner.regions.regions.resize(2);
    corner.regions.regions[1].small = true;
    for (int row = 0; row < kSide; ++row)
      for (int col = 8 - width / 2; col < 8 + width / 2; ++col)
        if (row % 7 != 0) corner.labels[corner.image.index(row, col)] = 2;
    corner.trim();
    EXPECT_EQ(std::count(corner.labels.begin(), corner.labels.end(), 2u) == 0, width == 4) << width;
  }
}

}  // namespace hybrid::testing
