#include "stages/scan/organised_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hybrid::testing::organised_grid_test {
namespace {

constexpr int kRows = 9, kCols = 14;

// Rays at even angles, ranges by node; column by column, rows upwards.
Scan dense_scan() {
  Scan scan;
  scan.name = "dense";
  scan.grid_rows = kRows;
  scan.grid_cols = kCols;
  for (int col = 0; col < kCols; ++col)
    for (int row = 0; row < kRows; ++row) {
      const double azimuth = 0.1 * col, elevation = 0.1 * (row - 3), range = 2 + 0.01 * (row * kCols + col);
      scan.points.push_back({static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
                             static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
                             static_cast<float>(range * std::sin(elevation))});
      scan.intensity.push_back(static_cast<float>(row * kCols + col));
    }
  return scan;
}

// The same samples shuffled, with their nodes.
Scan shuffled(const Scan& dense) {
  Scan scan = dense;
  std::vector<std::size_t> order(dense.points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t from = order[i];
    scan.points[i] = dense.points[from];
    scan.intensity[i] = dense.intensity[from];
    scan.node.push_back(static_cast<std::uint32_t>(from % kRows * kCols + from / kRows));
  }
  return scan;
}

TEST(OrganisedGrid, NodesInAnyOrderGiveTheSameImage) {
  const Scan dense = dense_scan(), mixed = shuffled(dense);
  const RangeImage a = stages::arrange_grid(dense), b = stages::arrange_grid(mixed);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.elevation_rad, b.elevation_rad);
  EXPECT_EQ(a.azimuth_rad, b.azimuth_rad);
  EXPECT_TRUE(b.extra.empty());
  for (std::size_t i = 0; i < b.count(); ++i) EXPECT_EQ(mixed.intensity[b.source[i]], b.intensity[i]);
}

TEST(OrganisedGrid, MissingSamplesAreEmptyAndFurtherReturnsExtra) {
  Scan scan = shuffled(dense_scan());
  const std::uint32_t node = scan.node[20];
  scan.points[20][0] = NAN;                // a no-return takes no node
  scan.points.push_back(scan.points[21]);  // ... so that a later return has it
  scan.intensity.push_back(500);
  scan.node.push_back(node);
  scan.points.push_back(scan.points[22]);  // a second return
  scan.intensity.push_back(600);
  scan.node.push_back(scan.node[22]);
  scan.points.push_back(scan.points[23]);  // one without a node
  scan.intensity.push_back(700);
  scan.node.push_back(Scan::kNoNode);
  const std::uint32_t gone = scan.node[30];
  scan.points.erase(scan.points.begin() + 30);
  scan.intensity.erase(scan.intensity.begin() + 30);
  scan.node.erase(scan.node.begin() + 30);
  const RangeImage image = stages::arrange_grid(scan);
  const auto last = static_cast<std::uint32_t>(scan.points.size()) - 1;
  EXPECT_EQ(image.extra, (std::vector<std::uint32_t>{last - 1, last}));
  EXPECT_EQ(std::count(image.mask.begin(), image.mask.end(), kMeasured), kRows * kCols - 1);
  const auto turned = [](std::uint32_t n) {  // the scan's rows go up, the image's down
    return static_cast<std::size_t>(kRows - 1 - static_cast<int>(n) / kCols) * kCols + n % kCols;
  };
  EXPECT_EQ(image.mask[turned(gone)], kEmpty);
  EXPECT_EQ(image.intensity[turned(node)], 500);
}

}  // namespace
}  // namespace hybrid::testing::organised_grid_test
