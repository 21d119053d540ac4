#include "stages/scan/resample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "device.hpp"
#include "stages/room_scan.hpp"

namespace hybrid::testing::resample_test {
namespace {

using stages::resample_scan;

void expect_same(const RangeImage& a, const RangeImage& b) {
  EXPECT_TRUE(same_bits(a.range_m, b.range_m));
  EXPECT_TRUE(same_bits(a.x, b.x));
  EXPECT_TRUE(same_bits(a.y, b.y));
  EXPECT_TRUE(same_bits(a.z, b.z));
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.extra, b.extra);
  EXPECT_EQ(a.intensity, b.intensity);
}

// Every return is the source of one node or an extra; nothing is both, twice or lost.
void expect_complete(const Scan& scan, const RangeImage& image) {
  std::vector<int> uses(scan.points.size());
  for (const auto source : image.source)
    if (source != kNoSource) ++uses[source];
  for (const auto extra : image.extra) ++uses[extra];
  for (const auto duplicate : image.duplicates) ++uses[duplicate];
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const auto& p = scan.points[i];
    const bool returned = std::isfinite(p[0] + p[1] + p[2]) && (p[0] != 0 || p[1] != 0 || p[2] != 0);
    ASSERT_EQ(uses[i], returned ? 1 : 0) << i;
  }
  EXPECT_TRUE(std::is_sorted(image.extra.begin(), image.extra.end()));
}

// A measured node holds its sample, verbatim; the others hold none.
void expect_verbatim(const Scan& scan, const RangeImage& image) {
  for (std::size_t i = 0; i < image.count(); ++i) {
    ASSERT_EQ(image.mask[i] == kMeasured, image.source[i] != kNoSource);
    ASSERT_EQ(image.mask[i] == kEmpty, std::isnan(image.range_m[i]));
    if (image.mask[i] != kMeasured) continue;
    const auto& p = scan.points[image.source[i]];
    ASSERT_EQ(image.x[i], p[0]);
    ASSERT_EQ(image.y[i], p[1]);
    ASSERT_EQ(image.z[i], p[2]);
    ASSERT_NEAR(image.range_m[i], image.point(i).norm(), 1e-6 * image.range_m[i]);
    ASSERT_TRUE(scan.intensity.empty() || image.intensity[i] == scan.intensity[image.source[i]]);
  }
}

// The grid as an organised scan, samples that `lost` names left out.
template <typename Lost>
Scan organised(const RangeImage& image, bool upwards, bool clockwise, const Lost& lost) {
  Scan scan;
  scan.grid_rows = image.rows;
  scan.grid_cols = image.cols;
  for (int c = 0; c < image.cols; ++c)
    for (int r = 0; r < image.rows; ++r) {
      const std::size_t i = image.index(upwards ? image.rows - 1 - r : r, clockwise ? image.cols - 1 - c : c);
      scan.points.push_back(lost(i) ? std::array<float, 3>{NAN, NAN, NAN}
                                    : std::array<float, 3>{image.x[i], image.y[i], image.z[i]});
    }
  return scan;
}

}  // namespace

TEST(Resample, measured_samples_stay_as_they_are_and_none_is_lost) {
  Scan scan = scan_room();
  scan.points[100] = {NAN, NAN, NAN};
  scan.points[200] = {0, 0, 0};
  scan.rgb.assign(scan.points.size(), {1, 2, 3});
  const RangeImage image = resample_scan(queue(), scan);
  expect_complete(scan, image);
  expect_verbatim(scan, image);
  EXPECT_EQ(image.cols, 240);
  EXPECT_TRUE(image.wraps);
  // Jitter puts two samples of a column into one row where the column runs half a step beside the rows.
  EXPECT_LT(image.extra.size(), scan.points.size() / 33);
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (image.mask[i] != kMeasured) continue;
    ASSERT_EQ(image.rgb[i], (std::array<std::uint8_t, 3>{1, 2, 3}));
    const double node = image.elevation_rad[i / static_cast<std::size_t>(image.cols)];
    const double elevation = std::asin(static_cast<double>(image.z[i]) / image.range_m[i]);
    ASSERT_LE(std::abs(elevation - node), 0.0101);  // half a step
  }
}

TEST(Resample, dropouts_are_interpolated_but_never_across_a_depth_jump) {
  RoomScanOptions options;
  options.dropouts = 0.15;
  options.columns = 400;
  Room room;
  room.pillar_high.z() = 0.3;  // seen over: jumps along the columns
  const Scan scan = scan_room(options, room);
  const RangeImage image = resample_scan(queue(), scan);
  std::size_t interpolated = 0, near_jumps = 0;
  for (int col = 0; col < image.cols; ++col)
    for (int row = 0; row < image.rows; ++row) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] != kInterpolated) continue;
      ++interpolated;
      // On the surface that its ray or one within two steps of it meets.
      double nearest = INFINITY, lowest = INFINITY, highest = 0;
      for (double steps = -2; steps <= 2; steps += 0.125) {
        const double elevation = image.elevation_rad[static_cast<std::size_t>(row)] + 0.02 * steps;
        const double truth =
            room.cast(direction(elevation, image.azimuth_rad[static_cast<std::size_t>(col)])).range_m;
        nearest = std::min(nearest, std::abs(truth - image.range_m[i]));
        lowest = std::min(lowest, truth);
        highest = std::max(highest, truth);
      }
      near_jumps += highest - lowest > 1;
      ASSERT_LT(nearest, 0.03) << row << " " << col;
    }
  EXPECT_GT(interpolated, scan.points.size() / 10);
  EXPECT_GT(near_jumps, 0u) << "the case must come near jumps";
}

TEST(Resample, gaps_longer_than_a_few_steps_stay_empty) {
  Scan scan = scan_room();
  scan.intensity.clear();
  std::erase_if(scan.points,
                [](const auto& p) { return std::abs(std::atan2(p[2], std::hypot(p[0], p[1]))) < 0.1; });
  const RangeImage image = resample_scan(queue(), scan);
  int checked = 0;
  for (int row = 0; row < image.rows; ++row) {
    if (std::abs(image.elevation_rad[static_cast<std::size_t>(row)]) > 0.08) continue;
    for (int col = 0; col < image.cols; ++col, ++checked)
      ASSERT_EQ(image.mask[image.index(row, col)], kEmpty);
  }
  EXPECT_GT(checked, 1000);
}

TEST(Resample, tiles_change_nothing) {
  RoomScanOptions options;
  options.columns = 300;
  options.dropouts = 0.1;
  const Scan scan = scan_room(options);
  stages::ResampleOptions tiles;
  tiles.tile = 16;
  const RangeImage expected = resample_scan(queue(), scan, tiles);
  for (const int side : {64, 1024}) {
    tiles.tile = side;
    expect_same(expected, resample_scan(queue(), scan, tiles));
  }
}

TEST(Resample, the_order_of_the_samples_changes_nothing) {
  Scan scan = scan_room();
  const RangeImage image = resample_scan(queue(), scan);
  std::shuffle(scan.points.begin(), scan.points.end(), std::mt19937(9));
  const RangeImage shuffled = resample_scan(queue(), scan);
  EXPECT_TRUE(same_bits(image.x, shuffled.x));
  EXPECT_TRUE(same_bits(image.range_m, shuffled.range_m));
  EXPECT_EQ(image.mask, shuffled.mask);
  EXPECT_EQ(image.extra.size(), shuffled.extra.size());
}

TEST(Resample, second_returns_are_kept_beside_the_grid) {
  const Scan scan = scan_room();
  Scan twice;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto& p = scan.points[i];
    twice.points.push_back(p);
    if (i % 3 == 0) twice.points.push_back({0.9f * p[0], 0.9f * p[1], 0.9f * p[2]});
  }
  const RangeImage image = resample_scan(queue(), twice);
  expect_complete(twice, image);
  expect_verbatim(twice, image);
  const double count = static_cast<double>(scan.points.size());
  EXPECT_NEAR(static_cast<double>(image.extra.size()), count / 3, 0.03 * count);
}

// Columns written again, whole and in part, and points many times in a row.
TEST(Resample, what_repeats_a_nodes_point_is_a_duplicate_and_all_else_is_extra) {
  constexpr int kTimes = 40;
  RoomScanOptions lone;
  lone.columns = 1;
  Scan scan;
  for (int c = 0; c < 60; ++c) {
    lone.first_azimuth_rad = 0.1 * c - 3;
    lone.seed = static_cast<unsigned>(c + 1);
    const Scan column = scan_room(lone);
    for (int time = 0; time <= c % 3; ++time) {
      const auto from = column.points.begin() + (time == 2 ? 40 : 0);
      scan.points.insert(scan.points.end(), from, column.points.end());
      if (time == 0) scan.points.insert(scan.points.end(), kTimes, column.points.back());
    }
  }
  const RangeImage image = resample_scan(queue(), scan);
  expect_complete(scan, image);
  std::set<std::array<float, 3>> in_nodes;
  for (const auto source : image.source)
    if (source != kNoSource) in_nodes.insert(scan.points[source]);
  for (const auto duplicate : image.duplicates)
    EXPECT_TRUE(in_nodes.contains(scan.points[duplicate])) << duplicate;
  for (const auto extra : image.extra) EXPECT_FALSE(in_nodes.contains(scan.points[extra])) << extra;
  EXPECT_GT(image.duplicates.size(), 60u * kTimes);
  EXPECT_GT(image.extra.size(), 10u);
}

TEST(Resample, the_scanners_own_body_is_kept_beside_the_grid) {
  const Scan scan = scan_room();
  const RangeImage truth = image_room(60, 90, 0.02, 0.002);
  const auto whole = [](std::size_t) { return false; };
  for (const Scan& input : {scan, organised(truth, false, false, whole)}) {
    const RangeImage all = resample_scan(queue(), input);
    auto ranges = all.range_m;
    std::nth_element(ranges.begin(), ranges.begin() + 500, ranges.end());  // NaN-free: the room is closed
    const double near = ranges[500];
    const RangeImage image = resample_scan(queue(), input, {.min_range_m = near});
    expect_complete(input, image);
    expect_verbatim(input, image);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < all.count(); ++i) {
      ASSERT_EQ(image.mask[i], all.range_m[i] < near ? std::uint8_t{kEmpty} : all.mask[i]);
      moved += all.range_m[i] < near && all.mask[i] == kMeasured;
    }
    EXPECT_GT(moved, 0u);
    EXPECT_EQ(image.extra.size(), all.extra.size() + moved);
  }
}

TEST(Resample, an_organised_scan_keeps_its_grid_however_it_is_turned) {
  const RangeImage truth = image_room(60, 90, 0.02, 0.002);
  const auto lost = [&](std::size_t i) { return i % 7 == 0 || i / 90 == 10; };  // a whole row, too
  for (const bool upwards : {false, true})
    for (const bool clockwise : {false, true}) {
      const Scan scan = organised(truth, upwards, clockwise, lost);
      const RangeImage image = resample_scan(queue(), scan);
      ASSERT_EQ(image.rows, truth.rows);
      ASSERT_EQ(image.cols, truth.cols);
      expect_complete(scan, image);
      EXPECT_TRUE(image.extra.empty());
      EXPECT_FALSE(image.wraps);
      for (std::size_t i = 0; i < image.count(); ++i) {
        ASSERT_EQ(image.mask[i], lost(i) ? kEmpty : kMeasured);
        ASSERT_TRUE(lost(i) || image.x[i] == truth.x[i]);
      }
      for (std::size_t r = 0; r < image.elevation_rad.size(); ++r)
        ASSERT_NEAR(image.elevation_rad[r], truth.elevation_rad[r], 1e-5);
      for (std::size_t c = 0; c < image.azimuth_rad.size(); ++c)
        ASSERT_NEAR(image.azimuth_rad[c], truth.azimuth_rad[c], 1e-5);
    }
}

TEST(Resample, sources_count_an_organised_files_samples_in_its_own_order) {
  const RangeImage truth = image_room(60, 90, 0.02, 0.002);
  const Scan by_columns = organised(truth, true, false, [](std::size_t i) { return i % 7 == 0; });
  Scan by_rows = by_columns;
  by_rows.row_by_row = true;
  for (int col = 0; col < truth.cols; ++col)
    for (int row = 0; row < truth.rows; ++row)
      by_rows.points[by_rows.grid_index(row, col)] = by_columns.points[by_columns.grid_index(row, col)];
  const RangeImage expected = resample_scan(queue(), by_columns), image = resample_scan(queue(), by_rows);
  expect_complete(by_rows, image);
  EXPECT_EQ(image.mask, expected.mask);
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (image.mask[i] != kMeasured) continue;
    ASSERT_EQ(image.x[i], expected.x[i]);
    ASSERT_EQ(by_rows.points[image.source[i]], by_columns.points[expected.source[i]]);
  }
}

TEST(Resample, an_organised_full_turn_wraps) {
  const RangeImage truth = image_room(20, 100, 2 * std::numbers::pi / 100, 0);
  const Scan scan = organised(truth, true, false, [](std::size_t) { return false; });
  EXPECT_TRUE(resample_scan(queue(), scan).wraps);
}

TEST(Resample, a_depth_images_grid_stays_as_it_is_with_its_own_steps) {
  Scan scan;  // camera frame: x right, y down, z forward; a wall at 2 m, focal length 500 pixels
  scan.grid_rows = 40;
  scan.grid_cols = 50;
  for (int c = 0; c < 50; ++c)
    for (int r = 0; r < 40; ++r)
      scan.points.push_back({2 * static_cast<float>(c - 25) / 500, 2 * static_cast<float>(r - 20) / 500, 2});
  const RangeImage image = resample_scan(queue(), scan);
  EXPECT_NEAR(image.elevation_step_rad(), 0.002, 1e-5);
  EXPECT_NEAR(image.azimuth_step_rad(), 0.002, 1e-5);
  EXPECT_EQ(image.source[image.index(3, 7)], 7u * 40 + 3);
  expect_complete(scan, image);
}

TEST(Resample, a_grid_of_the_wrong_size_or_without_returns_is_an_error) {
  Scan scan;
  scan.grid_rows = 3;
  scan.grid_cols = 4;
  scan.points.assign(11, {1, 1, 1});
  EXPECT_THROW(resample_scan(queue(), scan), Error);
  scan.points.assign(12, {NAN, NAN, NAN});
  EXPECT_THROW(resample_scan(queue(), scan), Error);
  EXPECT_THROW(resample_scan(queue(), Scan{}), Error);
}

TEST(Resample, its_options_have_the_ranges_they_say) {
  stages::ResampleOptions options;
  for (const auto& row : stages::resample_option_table()) {
    EXPECT_NO_THROW(set_option(options, row, get_option(options, row))) << row.name;
    EXPECT_THROW(set_option(options, row, OptionValue{1e9}), Error) << row.name;
  }
}

}  // namespace hybrid::testing::resample_test
