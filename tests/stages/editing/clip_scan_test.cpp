#include "stages/editing/clip_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

// Points 2 m away in all directions of a coarse grid; one node is empty, one interpolated.
RangeImage ball() {
  RangeImage image = make_range_image(9, 16);
  for (int row = 0; row < 9; ++row)
    for (int col = 0; col < 16; ++col) {
      const double el = (4 - row) * 0.3, az = col * M_PI / 8;
      const std::size_t i = image.index(row, col);
      image.x[i] = static_cast<float>(2 * std::cos(el) * std::cos(az));
      image.y[i] = static_cast<float>(2 * std::cos(el) * std::sin(az));
      image.z[i] = static_cast<float>(2 * std::sin(el));
      image.range_m[i] = 2;
      image.mask[i] = kMeasured;
    }
  image.mask[3] = kEmpty;
  image.mask[4] = kInterpolated;
  return image;
}

}  // namespace

TEST(ClipScan, every_shape_keeps_inside_or_outside) {
  const RangeImage image = ball();
  const ClipShape shapes[] = {ClipBox{{0, -3, -3}, {3, 3, 3}}, ClipHalfSpace{-Vec3::UnitX(), 0},
                              ClipPrism{{{0, -3}, {3, -3}, {3, 3}, {0, 3}}, -3, 3}};
  std::vector<std::uint8_t> first;
  for (const ClipShape& shape : shapes) {
    std::vector<std::uint8_t> outside(image.count(), 0), inside(image.count(), 0);
    clip_nodes(image, Pose{}, shape, false, outside);
    clip_nodes(image, Pose{}, shape, true, inside);
    for (std::size_t i = 0; i < image.count(); ++i) {
      EXPECT_EQ(outside[i] + inside[i], image.mask[i] == kMeasured ? 1 : 0) << i;
      if (image.mask[i] == kMeasured && std::abs(image.x[i]) > 1e-3) {
        EXPECT_EQ(outside[i], image.x[i] > 0) << i;
      }
    }
    if (first.empty()) first = outside;
  }
}

TEST(ClipScan, shapes_stand_in_their_own_frame) {
  const RangeImage image = ball();
  const Pose shifted{1, Eigen::Quaterniond::Identity(), Vec3(10, 0, 0)};
  std::vector<std::uint8_t> clipped(image.count(), 0);
  EXPECT_EQ(clip_nodes(image, shifted, ClipBox{{-3, -3, -3}, {3, 3, 3}}, false, clipped), 0);
  EXPECT_EQ(clip_nodes(image, shifted, ClipBox{{7, -3, -3}, {13, 3, 3}}, false, clipped), 9 * 16 - 2);
  EXPECT_EQ(clip_nodes(image, shifted, ClipBox{{7, -3, -3}, {13, 3, 3}}, false, clipped), 0);  // counted once
}

TEST(MoveArea, moves_along_the_rays_and_nothing_else) {
  RangeImage image = ball();
  const RangeImage before = image;
  const auto moved = move_area(image, {{2, 5}, {2, 8}, {4, 8}, {4, 5}}, 0.25);
  EXPECT_EQ(std::accumulate(moved.begin(), moved.end(), 0), 3 * 4);  // the border takes part
  for (int row = 0; row < 9; ++row)
    for (int col = 0; col < 16; ++col) {
      const std::size_t i = image.index(row, col);
      const bool in = row >= 2 && row <= 4 && col >= 5 && col <= 8;
      EXPECT_EQ(moved[i], in);
      EXPECT_NEAR(image.point(i).norm(), in ? 2.25 : 2, 1e-5);
      EXPECT_FLOAT_EQ(image.range_m[i], in ? 2.25f : 2.0f);
      EXPECT_NEAR(image.point(i).normalized().dot(before.point(i).normalized()), 1, 1e-6);
    }
}

TEST(MoveArea, wrong_areas_are_errors) {
  RangeImage image = ball();
  EXPECT_THROW(move_area(image, {{0, 0}, {0, 16}, {3, 3}}, 0.1), Error);  // outside
  EXPECT_THROW(move_area(image, {{0, 6}, {0, 9}, {4, 9}}, -2), Error);    // to the scanner
}

TEST(MoveArea, points_beside_the_grid_belong_to_the_node_they_lie_towards) {
  RangeImage image = ball();
  for (int row = 0; row < 9; ++row) image.elevation_rad[static_cast<std::size_t>(row)] = (4 - row) * 0.3;
  for (int col = 0; col < 16; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = col * M_PI / 8;
  image.wraps = true;
  std::vector<Vec3> points;
  for (const std::size_t node : {image.index(1, 6), image.index(2, 5), image.index(3, 9), image.index(4, 8)})
    points.push_back(1.5 * image.point(node) + Vec3(0.01, 0, 0.01));
  EXPECT_EQ(points_in_area(image, points, {{2, 5}, {2, 8}, {4, 8}, {4, 5}}),
            (std::vector<std::size_t>{1, 3}));
}

}  // namespace hybrid::stages
