#include "stages/planes/mixed_rims.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "stages/planes/beam_width.hpp"

namespace hybrid::testing::mixed_rims_test {
namespace {

constexpr int kSide = 60, kEdge = 30;  // columns; the wall ends before kEdge
constexpr double kSigma_m = 0.001, kWall_m = 5;

// A wall (label 1) 5 m ahead up to column kEdge, another surface `behind_m` beyond it from there on;
// neighbours lie `spacing_m` apart. `height` (row, col): metres beyond the wall that its samples are off.
struct Corner {
  double behind_m = 0.5, spacing_m = 0.005;
  stages::BeamWidth beam{0.01, 0};
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
    return stages::trim_mixed_rims(image, stages::RangeNoise{kSigma_m}, beam, {3.5, 0.005}, planes, regions,
                                   labels);
  }
  std::int64_t left_in_column(int col) const {
    std::int64_t count = 0;
    for (int row = 0; row < kSide; ++row) count += labels[image.index(row, col)] == 1;
    return count;
  }
};

std::function<double(int, int)> two_columns_lean(double sigmas) {
  return [=](int, int col) { return col >= kEdge - 2 ? sigmas * kSigma_m : 0; };
}

}  // namespace

TEST(MixedRims, samples_that_lean_to_the_surface_behind_lose_their_label) {
  Corner corner;
  corner.behind_m = 0.03;
  corner.height = two_columns_lean(4);
  const auto lost = corner.trim();
  EXPECT_LE(corner.left_in_column(kEdge - 1), kSide / 20);
  EXPECT_LE(corner.left_in_column(kEdge - 2), kSide / 20);
  EXPECT_GE(corner.left_in_column(kEdge - 3), kSide - kSide / 20);
  EXPECT_EQ(lost[1], kSide * kEdge - std::count(corner.labels.begin(), corner.labels.end(), 1u));
}

TEST(MixedRims, a_clean_edge_keeps_its_samples) {
  for (const double behind_m : {0.03, 0.5}) {
    Corner corner;
    corner.behind_m = behind_m;
    EXPECT_LE(corner.trim()[1], kSide / 20) << behind_m;
  }
}

// Of what mixes with a surface that far behind, hardly any lies within noise of the plane.
TEST(MixedRims, what_leans_to_a_surface_far_behind_is_noise) {
  Corner corner;
  corner.height = two_columns_lean(2);
  EXPECT_LE(corner.trim()[1], kSide / 20);
}

TEST(MixedRims, samples_that_lean_to_the_other_side_are_no_mixtures) {
  Corner corner;
  corner.behind_m = 0.03;
  corner.height = two_columns_lean(-2);
  EXPECT_EQ(corner.trim()[1], 0);
}

TEST(MixedRims, where_walls_stray_from_their_planes_leaning_is_no_sign) {
  Corner corner;
  corner.behind_m = 0.03;
  corner.height = [](int row, int) { return row % 8 < 4 ? 4 * kSigma_m : -4 * kSigma_m; };
  EXPECT_LE(corner.trim()[1], kSide / 20);
}

TEST(MixedRims, beams_much_narrower_than_the_spacing_or_unknown_mix_little) {
  for (const double width_m : {0.0005, 0.0}) {
    Corner corner;
    corner.behind_m = 0.03;
    corner.height = two_columns_lean(2);
    corner.beam.base_m = width_m;
    EXPECT_LE(corner.trim()[1], width_m > 0 ? kSide / 10 : 0) << width_m;
  }
}

TEST(MixedRims, without_a_jump_nothing_is_mixed) {
  Corner corner;
  corner.height = two_columns_lean(2);
  corner.behind_m = 0.008;
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

namespace {

// A wall 5 m ahead and another a metre behind it with `gap` nodes of neither between them in the upper half,
// which show how wide the beam is; in the lower, a surface that recedes by `slope` up to the middle and meets
// a wall there, halfway between two nodes. Neighbours lie 5 mm apart; no noise.
struct Creased {
  static constexpr int kRows = 120, kCols = 60, kMiddle = 30;
  static constexpr double kSpacing_m = 0.005;
  RangeImage image = make_range_image(kRows, kCols);
  std::vector<std::uint32_t> labels = std::vector<std::uint32_t>(image.count());
  std::vector<Plane> planes;
  stages::PlaneRegions regions;

  Creased(int gap, double slope) {
    const double crease_y = kSpacing_m * -0.5;
    const Vec3 receding = Vec3(-1, slope, 0).normalized();
    planes = {{-Vec3::UnitX(), -kWall_m},
              {-Vec3::UnitX(), -kWall_m - 1},
              {receding, receding.dot(Vec3(kWall_m, crease_y, 0))},
              {-Vec3::UnitX(), -kWall_m}};
    regions.regions.resize(planes.size());
    for (int row = 0; row < kRows; ++row) {
      image.elevation_rad[static_cast<std::size_t>(row)] = kSpacing_m / kWall_m * (kRows / 2 - row);
      for (int col = 0; col < kCols; ++col) {
        image.azimuth_rad[static_cast<std::size_t>(col)] = kSpacing_m / kWall_m * (col - kMiddle);
        const bool upper = row < kRows / 2, left = col < kMiddle;
        const std::uint32_t label = upper ? (left ? 1 : 2) : (left ? 3 : 4);
        const Vec3 ray(1, kSpacing_m / kWall_m * (col - kMiddle), kSpacing_m / kWall_m * (kRows / 2 - row));
        const Plane& plane = planes[label - 1];
        const int into_gap = col - (kMiddle - gap / 2);
        const bool mixed = upper && into_gap >= 0 && into_gap < gap;
        const Vec3 point = mixed ? Vec3(ray * (kWall_m + (into_gap + 1.0) / (gap + 1)))
                                 : Vec3(ray * (plane.offset_m / plane.normal.dot(ray)));
        const std::size_t i = image.index(row, col);
        image.mask[i] = kMeasured;
        image.x[i] = static_cast<float>(point.x());
        image.y[i] = static_cast<float>(point.y());
        image.z[i] = static_cast<float>(point.z());
        labels[i] = mixed ? 0 : label;
      }
    }
  }
  std::vector<std::int64_t> trim() {
    const stages::BeamWidth beam =
        stages::measure_beam(image, stages::RimCrossings(image, planes, regions, labels), labels);
    return stages::trim_mixed_rims(image, stages::RangeNoise{kSigma_m}, beam, {3.5, 0.005}, planes, regions,
                                   labels);
  }
};

}  // namespace

TEST(MixedRims, half_a_beam_beside_a_crease_is_mixed_where_the_surfaces_part_soon) {
  const auto steep = Creased(2, 10).trim(), wide = Creased(4, 10).trim(), shallow = Creased(2, 0.5).trim();
  const int rows = Creased::kRows / 2;
  EXPECT_EQ(steep[3], rows);  // the nearest column: half a node from the crease, half a beam is a node
  EXPECT_EQ(steep[4], rows);
  EXPECT_EQ(wide[3], 2 * rows);  // half a beam is two nodes
  EXPECT_EQ(wide[4], 2 * rows);
  EXPECT_EQ(shallow[3] + shallow[4], 0);
  EXPECT_EQ(steep[1] + steep[2], 0);
}

TEST(MixedRims, the_beam_is_as_wide_as_the_unlabelled_between_surfaces_far_apart) {
  for (const int gap : {2, 3}) {
    Creased scan(gap, 10);
    const stages::RimCrossings crossings(scan.image, scan.planes, scan.regions, scan.labels);
    const stages::BeamWidth beam = stages::measure_beam(scan.image, crossings, scan.labels);
    EXPECT_NEAR(beam.at(5), gap * Creased::kSpacing_m, 0.0005) << gap;  // the rays' angles are not quite even
  }
  Creased none(14, 10);  // farther apart than is looked
  const stages::RimCrossings crossings(none.image, none.planes, none.regions, none.labels);
  EXPECT_EQ(stages::measure_beam(none.image, crossings, none.labels).at(5), 0);
}

}  // namespace hybrid::testing::mixed_rims_test
