#include "stages/scan/organised_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "geometry/angles.hpp"
#include "io/scan_frame.hpp"

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

using stages::GridLayout;

// The samples of `dense` in another order: the k-th of them is that of node (row, col) = place(k).
template <typename PlaceOf>
Scan reordered(const Scan& dense, const PlaceOf& place) {
  Scan scan = dense;
  for (int k = 0; k < kRows * kCols; ++k) {
    const auto [row, col] = place(k);
    const std::size_t from = dense.grid_index(row, col), to = static_cast<std::size_t>(k);
    scan.points[to] = dense.points[from];
    scan.intensity[to] = dense.intensity[from];
  }
  return scan;
}

void expect_grid_of(const RangeImage& expected, const RangeImage& image) {
  ASSERT_EQ(image.rows, expected.rows);
  ASSERT_EQ(image.cols, expected.cols);
  EXPECT_EQ(image.range_m, expected.range_m);
  EXPECT_EQ(image.intensity, expected.intensity);
  EXPECT_EQ(image.elevation_rad, expected.elevation_rad);
  EXPECT_EQ(image.azimuth_rad, expected.azimuth_rad);
  EXPECT_EQ(std::count(image.mask.begin(), image.mask.end(), kMeasured), kRows * kCols);
}

// Headers that say rows for columns, and samples along the rows in a format that goes down the columns.
TEST(OrganisedGrid, IsTurnedAsItsSamplesLie) {
  const Scan dense = dense_scan();
  GridLayout layout = GridLayout::no_angles;
  const RangeImage expected = stages::arrange_grid(dense, &layout);
  EXPECT_EQ(layout, GridLayout::as_filed);
  const auto by_rows = [](int k) { return std::pair{k / kCols, k % kCols}; };
  const auto by_columns = [](int k) { return std::pair{k % kRows, k / kRows}; };

  Scan transposed = reordered(dense, by_rows);  // in the file's words down its columns
  transposed.grid_rows = kCols;
  transposed.grid_cols = kRows;
  const RangeImage turned = stages::arrange_grid(transposed, &layout);
  EXPECT_EQ(layout, GridLayout::transposed);
  expect_grid_of(expected, turned);
  for (std::size_t i = 0; i < turned.count(); ++i)
    EXPECT_EQ(transposed.intensity[turned.source[i]], turned.intensity[i]);

  Scan swapped = reordered(dense, by_columns);
  swapped.grid_rows = kCols;
  swapped.grid_cols = kRows;
  expect_grid_of(expected, stages::arrange_grid(swapped, &layout));
  EXPECT_EQ(layout, GridLayout::dimensions_swapped);
  swapped = reordered(dense, by_rows);
  swapped.grid_rows = kCols;
  swapped.grid_cols = kRows;
  swapped.row_by_row = true;
  expect_grid_of(expected, stages::arrange_grid(swapped, &layout));
  EXPECT_EQ(layout, GridLayout::dimensions_swapped);

  const Scan rows = reordered(dense, by_rows);
  expect_grid_of(expected, stages::arrange_grid(rows, &layout));
  EXPECT_EQ(layout, GridLayout::other_order);
  Scan columns = reordered(dense, by_columns);
  columns.row_by_row = true;
  expect_grid_of(expected, stages::arrange_grid(columns, &layout));
  EXPECT_EQ(layout, GridLayout::other_order);
}

// A file that says each sample's node can be turned, but has no order to read otherwise.
TEST(OrganisedGrid, WithNodesIsTurnedToo) {
  const Scan dense = dense_scan();
  Scan mixed = shuffled(dense);
  for (std::uint32_t& node : mixed.node) node = node % kCols * kRows + node / kCols;
  std::swap(mixed.grid_rows, mixed.grid_cols);
  GridLayout layout = GridLayout::no_angles;
  expect_grid_of(stages::arrange_grid(dense), stages::arrange_grid(mixed, &layout));
  EXPECT_EQ(layout, GridLayout::transposed);

  // As an image of the file's grid, its rows the other way round.
  RangeImage image = make_range_image(kCols, kRows);
  image.intensity.assign(image.count(), 0);
  for (std::size_t i = 0; i < mixed.points.size(); ++i) {
    const int row = static_cast<int>(mixed.node[i]) / kRows, col = static_cast<int>(mixed.node[i]) % kRows;
    const std::size_t at = image.index(kCols - 1 - row, col);
    image.x[at] = mixed.points[i][0];
    image.y[at] = mixed.points[i][1];
    image.z[at] = mixed.points[i][2];
    image.range_m[at] = static_cast<float>(mixed.point(i).norm());
    image.mask[at] = kMeasured;
    image.source[at] = static_cast<std::uint32_t>(i);
    image.intensity[at] = mixed.intensity[i];
  }
  EXPECT_EQ(stages::orient_grid(image, true, false), GridLayout::transposed);
  expect_grid_of(stages::arrange_grid(dense), image);
}

// A mirror that sweeps a full circle while the head turns half of one.
TEST(OrganisedGrid, ColumnsOverTheZenithAreCutThere) {
  constexpr int kBefore = 10, kBehind = 7, kColumns = 12;  // of 15 degrees, the lowest 1 row before it ends
  Scan scan;
  scan.grid_rows = kBefore + kBehind;
  scan.grid_cols = kColumns;
  for (int col = 0; col < kColumns; ++col)
    for (int row = 0; row < scan.grid_rows; ++row) {
      const double sweep = (row - kBefore + 0.5) * 10 * kDegree + kTurn / 4,
                   azimuth = (col + 0.2) * 15 * kDegree;
      const double range = 3 + 0.01 * row;
      scan.points.push_back({static_cast<float>(range * std::cos(sweep) * std::cos(azimuth)),
                             static_cast<float>(range * std::cos(sweep) * std::sin(azimuth)),
                             static_cast<float>(range * std::sin(sweep))});
    }
  GridLayout layout = GridLayout::no_angles;
  const RangeImage image = stages::arrange_grid(scan, &layout);
  EXPECT_EQ(layout, GridLayout::over_zenith);
  ASSERT_EQ(image.rows, kBefore);
  ASSERT_EQ(image.cols, 2 * kColumns);
  EXPECT_TRUE(image.wraps);
  EXPECT_EQ(std::count(image.mask.begin(), image.mask.end(), kMeasured), (kBefore + kBehind) * kColumns);
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] == kEmpty) continue;
      const Vec3 p = image.point(i);
      EXPECT_NEAR(std::atan2(p.z(), p.head<2>().norm()), image.elevation_rad[static_cast<std::size_t>(row)],
                  1e-6);
      EXPECT_NEAR(
          std::remainder(std::atan2(p.y(), p.x()) - image.azimuth_rad[static_cast<std::size_t>(col)], kTurn),
          0, 1e-6);
    }
}

// Neighbours that lie in any directions make no table of many turns, which no range image may have.
TEST(OrganisedGrid, OfScrambledSamplesStaysWithinATurn) {
  Scan scan = dense_scan();
  scan.grid_rows = 2 * kRows;
  scan.grid_cols = kCols / 2;
  for (std::size_t i = 0; i < scan.points.size(); i += 2)
    for (float& length : scan.points[i]) length = -length;
  std::shuffle(scan.points.begin(), scan.points.end(), std::mt19937(7));
  GridLayout layout = GridLayout::as_filed;
  const RangeImage image = stages::arrange_grid(scan, &layout);
  EXPECT_EQ(layout, GridLayout::no_angles);
  EXPECT_LE(image.azimuth_rad.back() - image.azimuth_rad.front(), kTurn);
  EXPECT_LE(image.elevation_rad.front() - image.elevation_rad.back(), kTurn);
}

TEST(OrganisedGrid, OfACameraLookingAlongZIsNoGridOfAngles) {
  Scan scan;
  scan.grid_rows = kRows;
  scan.grid_cols = kCols;
  scan.row_by_row = true;
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col)
      scan.points.push_back({static_cast<float>(0.1 * (col - 6.5)), static_cast<float>(0.1 * (row - 4)), 1});
  GridLayout layout = GridLayout::as_filed;
  EXPECT_EQ(stages::arrange_grid(scan, &layout).rows, kRows);
  EXPECT_EQ(layout, GridLayout::no_angles);
  io::turn_axes(scan, io::ScanAxes::camera);
  const RangeImage image = stages::arrange_grid(scan, &layout);
  EXPECT_EQ(layout, GridLayout::as_filed);
  EXPECT_EQ(image.source[image.index(0, kCols - 1)], 0u);  // columns go with the azimuth: to the left
  EXPECT_EQ(image.source[image.index(kRows - 1, 0)], static_cast<std::uint32_t>(kRows * kCols - 1));
}

}  // namespace
}  // namespace hybrid::testing::organised_grid_test
