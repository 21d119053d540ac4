#include "stages/scan/columns.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "stages/room_scan.hpp"
#include "stages/scan/sweeps.hpp"

namespace hybrid::testing::columns_test {
namespace {

using stages::recover_columns;
using stages::ScanColumns;

// Each return once, columns by azimuth, samples of a column by descending elevation.
void expect_in_order(const Scan& scan, const ScanColumns& columns) {
  std::vector<int> seen(scan.points.size());
  for (const auto sample : columns.samples) ++seen[sample];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(scan.points.size()));
  EXPECT_TRUE(std::is_sorted(columns.azimuth_rad.begin(), columns.azimuth_rad.end()));
  ASSERT_EQ(columns.begin.size(), columns.azimuth_rad.size() + 1);
  for (std::size_t c = 0; c + 1 < columns.begin.size(); ++c)
    for (std::size_t k = columns.begin[c]; k < columns.begin[c + 1]; ++k) {
      ASSERT_GE(columns.row_position[k], -0.51f);
      ASSERT_LE(columns.row_position[k], static_cast<float>(columns.rows) - 0.49f);
      ASSERT_TRUE(k == columns.begin[c] || columns.row_position[k] >= columns.row_position[k - 1]);
      const auto& p = scan.points[columns.samples[k]];
      const double off =
          std::remainder(std::atan2(p[1], p[0]) - columns.azimuth_rad[c], 2 * std::numbers::pi);
      ASSERT_LT(std::abs(off) * std::hypot(p[0], p[1]), 0.05);
    }
}

std::string error_of(const Scan& scan) {
  try {
    recover_columns(scan);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "";
}

}  // namespace

TEST(Columns, a_full_turn_in_acquisition_order_is_recovered) {
  const Scan scan = scan_room();
  const ScanColumns columns = recover_columns(scan);
  expect_in_order(scan, columns);
  EXPECT_EQ(columns.count(), 240);
  EXPECT_TRUE(columns.wraps);
  EXPECT_NEAR(columns.elevation_step_rad, 0.02, 1e-5);
  EXPECT_NEAR(columns.rows, 2.5 / 0.02, 2);
}

TEST(Columns, sweeps_down_and_to_and_fro_give_the_same_columns) {
  const Scan up = scan_room();
  const ScanColumns expected = recover_columns(up);
  for (const bool to_and_fro : {false, true}) {
    Scan turned = up;
    turned.points.clear();
    for (std::size_t c = 0; c + 1 < expected.begin.size(); ++c) {
      std::vector<std::array<float, 3>> column;
      for (std::size_t k = expected.begin[c]; k < expected.begin[c + 1]; ++k)
        column.push_back(up.points[expected.samples[k]]);
      if (to_and_fro && c % 2 == 1) std::reverse(column.begin(), column.end());
      turned.points.insert(turned.points.end(), column.begin(), column.end());
    }
    const ScanColumns columns = recover_columns(turned);
    expect_in_order(turned, columns);
    EXPECT_EQ(columns.begin, expected.begin);
    EXPECT_EQ(columns.rows, expected.rows);
    EXPECT_NEAR(columns.elevation_step_rad, expected.elevation_step_rad, 1e-9);
  }
}

TEST(Columns, a_column_that_starts_higher_than_the_last_one_ended_is_its_own) {
  RoomScanOptions low, high;
  low.columns = high.columns = 1;
  low.highest_rad = 0;
  high.lowest_rad = 0.3;
  Scan scan;
  for (int c = 0; c < 40; ++c) {
    low.first_azimuth_rad = high.first_azimuth_rad = 0.02 * c;
    const Scan part = scan_room(c % 2 ? high : low);
    scan.points.insert(scan.points.end(), part.points.begin(), part.points.end());
  }
  const ScanColumns columns = recover_columns(scan);
  expect_in_order(scan, columns);
  EXPECT_EQ(columns.count(), 40);
}

// As the real pcl-room scans do, which record each column twice.
TEST(Columns, repeated_columns_share_one) {
  RoomScanOptions once;
  once.columns = 1;
  Scan scan;
  for (int c = 0; c < 60; ++c) {
    once.first_azimuth_rad = 0.1 * c - 3;
    once.seed = static_cast<unsigned>(c);
    const Scan column = scan_room(once);
    for (int twice = 0; twice < 2; ++twice)
      scan.points.insert(scan.points.end(), column.points.begin(), column.points.end());
  }
  const ScanColumns columns = recover_columns(scan);
  expect_in_order(scan, columns);
  EXPECT_EQ(columns.sweeps, 120u);
  EXPECT_EQ(columns.count(), 60);
}

TEST(Columns, a_cloud_in_any_order_falls_back_to_clusters_of_azimuth) {
  const Scan scan = scan_room();
  Scan shuffled = scan;
  std::shuffle(shuffled.points.begin(), shuffled.points.end(), std::mt19937(4));
  const ScanColumns expected = recover_columns(scan), columns = recover_columns(shuffled);
  expect_in_order(shuffled, columns);
  EXPECT_EQ(columns.begin, expected.begin);
  EXPECT_EQ(columns.rows, expected.rows);
  EXPECT_EQ(columns.wraps, expected.wraps);
  for (std::size_t k = 0; k < columns.samples.size(); ++k)
    ASSERT_EQ(shuffled.points[columns.samples[k]], scan.points[expected.samples[k]]);
}

// Up and down again at one azimuth, so that it is the turn alone that parts two sweeps. Samples are followed
// in blocks, each as if nothing was known of the one before.
TEST(Columns, a_sweep_ends_where_the_mirror_turns_wherever_that_is_in_the_file) {
  constexpr std::size_t kBlock = 1 << 16;
  RoomScanOptions regular;
  regular.columns = 150;
  regular.step_rad = 0.008;
  regular.start_steps = regular.jitter_steps = regular.dropouts = 0;
  const Scan up = scan_room(regular);
  const std::size_t rows = up.points.size() / 150;
  Scan scan = up;
  scan.points.clear();
  std::vector<std::size_t> begins;
  for (std::size_t c = 0; c < 150; ++c) {
    const auto first = up.points.begin() + static_cast<std::ptrdiff_t>(c * rows),
               last = first + static_cast<std::ptrdiff_t>(rows);
    begins.push_back(scan.points.size());
    scan.points.insert(scan.points.end(), first, last);
    begins.push_back(scan.points.size());
    scan.points.insert(scan.points.end(), std::make_reverse_iterator(last - 1),
                       std::make_reverse_iterator(first));
  }
  begins.push_back(scan.points.size());
  const std::size_t turn = begins[kBlock / rows / 2 * 2 + 3];
  ASSERT_GT(turn, kBlock + 2);
  for (const std::size_t at : {kBlock - 2, kBlock - 1, kBlock, kBlock + 1, kBlock + 2}) {
    const std::size_t without = turn - at;
    Scan later = scan;
    later.points.erase(later.points.begin(), later.points.begin() + static_cast<std::ptrdiff_t>(without));
    std::vector<std::size_t> wanted{0};
    for (const std::size_t begin : begins)
      if (begin > without) wanted.push_back(begin - without);
    EXPECT_EQ(stages::sweeps_of_acquisition(stages::sample_angles(later)).begin, wanted) << at;
  }
}

TEST(Columns, samples_listed_by_rows_are_columns_too) {
  RoomScanOptions regular;
  regular.start_steps = regular.jitter_steps = regular.dropouts = 0;
  const Scan scan = scan_room(regular);
  const std::size_t cols = 240, rows = scan.points.size() / cols;
  Scan by_rows = scan;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < cols; ++c) by_rows.points[r * cols + c] = scan.points[c * rows + r];
  const ScanColumns columns = recover_columns(by_rows);
  expect_in_order(by_rows, columns);
  EXPECT_EQ(columns.count(), 240);
  EXPECT_EQ(columns.rows, static_cast<int>(rows));
}

TEST(Columns, rows_lie_on_the_samples_when_all_columns_start_alike) {
  RoomScanOptions regular;
  regular.start_steps = regular.jitter_steps = 0;
  const ScanColumns columns = recover_columns(scan_room(regular));
  for (const float position : columns.row_position) ASSERT_NEAR(position, std::round(position), 0.01);
}

TEST(Columns, part_of_a_turn_across_the_seam_stays_in_one_piece) {
  RoomScanOptions part;
  part.columns = 60;
  part.first_azimuth_rad = 2.5;
  part.turn_rad = 1.5;
  const Scan scan = scan_room(part);
  const ScanColumns columns = recover_columns(scan);
  expect_in_order(scan, columns);
  EXPECT_FALSE(columns.wraps);
  EXPECT_EQ(columns.count(), 60);
  EXPECT_NEAR(columns.azimuth_rad.front(), 2.5, 1e-4);
  EXPECT_NEAR(columns.azimuth_rad.back(), 2.5 + 1.5 * 59 / 60, 1e-4);
}

TEST(Columns, missing_columns_leave_empty_ones) {
  RoomScanOptions options;
  options.columns = 120;
  options.turn_rad = 2.4;
  Scan scan = scan_room(options);
  // Columns 50 to 57, at azimuths from -2.1, fall out.
  std::erase_if(scan.points, [](const auto& p) {
    const double azimuth = std::atan2(p[1], p[0]);
    return azimuth > -2.11 && azimuth < -1.95;
  });
  const ScanColumns columns = recover_columns(scan);
  expect_in_order(scan, columns);
  EXPECT_EQ(columns.count(), 120);
  EXPECT_EQ(columns.begin[50], columns.begin[58]);
  EXPECT_NEAR(columns.azimuth_rad[53], -3.1 + 2.4 * 53 / 120, 1e-3);
}

TEST(Columns, a_lone_column_is_a_grid_of_one) {
  RoomScanOptions lone;
  lone.columns = 1;
  const Scan scan = scan_room(lone);
  const ScanColumns columns = recover_columns(scan);
  EXPECT_EQ(columns.count(), 1);
  EXPECT_FALSE(columns.wraps);
  EXPECT_EQ(columns.samples.size(), scan.points.size());
}

TEST(Columns, no_returns_are_an_error_that_says_so) {
  Scan scan;
  scan.name = "west";
  scan.points.assign(100, {NAN, 0, 0});
  scan.points.push_back({0, 0, 0});
  EXPECT_EQ(
      error_of(scan),
      "expected returns, found none among 101 samples; export the scan again with its points, or leave it "
      "out");
}

TEST(Columns, an_organised_file_of_one_line_is_told_that_it_is_no_grid) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  Scan scan;
  scan.grid_rows = 1;
  scan.grid_cols = 200;
  for (int i = 0; i < 200; ++i) scan.points.push_back({normal(random), normal(random), normal(random)});
  const std::string error = error_of(scan);
  EXPECT_NE(error.find("its grid of 1 x 200 is a single line"), std::string::npos) << error;
  EXPECT_EQ(error.find("use an organised file"), std::string::npos) << error;
}

TEST(Columns, points_without_structure_are_an_error_that_says_so) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (const int count : {1, 5, 200, 20000}) {
    Scan scan;
    scan.name = "cloud";
    for (int i = 0; i < count; ++i) scan.points.push_back({normal(random), normal(random), normal(random)});
    EXPECT_NE(error_of(scan).find("no columns found"), std::string::npos) << count;
  }
}

}  // namespace hybrid::testing::columns_test
