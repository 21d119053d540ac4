// Clouds without columns, whose scanner's position is known.
#include "stages/scan/scattered.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "cases/trial_room.hpp"
#include "core/error.hpp"
#include "device.hpp"
#include "io/scan_frame.hpp"
#include "stages/scan/columns.hpp"
#include "stages/scan/resample.hpp"
#include "stages/scan/sweeps.hpp"

namespace hybrid::testing {
namespace {

// Directions even over the sphere, those below `lowest` (sine of elevation) left out; ranges as of a box.
Scan scattered_box(int samples, double lowest = -1) {
  Draw draw(7);
  Scan scan;
  scan.name = "box";
  while (std::ssize(scan.points) < samples) {
    const double z = draw.within(-1, 1), azimuth = draw.within(-std::numbers::pi, std::numbers::pi);
    if (z < lowest) continue;
    const double level = std::sqrt(1 - z * z);
    const Vec3 ray(level * std::cos(azimuth), level * std::sin(azimuth), z);
    const Vec3 point =
        ray * std::min({3 / std::abs(ray.x()), 2 / std::abs(ray.y()), 1.5 / std::abs(ray.z())});
    scan.points.push_back(
        {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())});
  }
  return scan;
}

}  // namespace

TEST(Scattered, the_step_is_that_of_the_samples) {
  constexpr int kSamples = 40000;
  const auto step = [](const Scan& scan) {
    return stages::scatter_sweeps(stages::sample_angles(scan)).step_rad;
  };
  // One sample in a square of the step's side.
  EXPECT_NEAR(step(scattered_box(kSamples)), std::sqrt(4 * std::numbers::pi / kSamples), 4e-4);
  // Half the sphere is twice as dense.
  EXPECT_NEAR(step(scattered_box(kSamples, 0)), std::sqrt(2 * std::numbers::pi / kSamples), 4e-4);
}

TEST(Scattered, the_order_of_the_samples_changes_nothing) {
  Scan scan = scattered_box(20000);
  scan.scanner_is_known = true;
  const auto image = stages::resample_scan(queue(), scan);
  std::reverse(scan.points.begin(), scan.points.end());
  const auto reversed = stages::resample_scan(queue(), scan);
  EXPECT_EQ(image.rows, reversed.rows);
  EXPECT_EQ(image.azimuth_rad, reversed.azimuth_rad);
  EXPECT_EQ(image.mask, reversed.mask);
  EXPECT_TRUE(std::equal(image.range_m.begin(), image.range_m.end(), reversed.range_m.begin(),
                         [](float a, float b) { return a == b || (a != a && b != b); }));
}

TEST(Scattered, every_sample_is_at_a_node_or_beside_the_grid) {
  Scan scan = scattered_box(20000);
  scan.scanner_is_known = true;
  const auto image = stages::resample_scan(queue(), scan);
  EXPECT_TRUE(image.wraps);
  std::vector<int> seen(scan.points.size());
  for (const std::uint32_t source : image.source)
    if (source != kNoSource) ++seen[source];
  const auto at_nodes = std::count(seen.begin(), seen.end(), 1);
  for (const std::uint32_t sample : image.extra) ++seen[sample];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 20000);
  // Of Poisson's distribution with a mean of 1: 63 % of the squares hold a sample, and more towards the
  // poles.
  EXPECT_GT(at_nodes, 0.6 * 20000);
}

// As where coordinates of a survey are given and a scanner's position in other ones: millions of bins to the
// turn, which are neither counted one by one nor need memory.
TEST(Scattered, a_scanner_thousands_of_kilometres_away_gives_a_fine_grid_or_none) {
  Scan scan = scattered_box(20000);
  scan.origin = Vec3(5e5, 5e6, 100);
  scan.scanner_is_known = true;
  const stages::SampleAngles angles = stages::sample_angles(scan);
  const auto [sweeps, step_rad] = stages::scatter_sweeps(angles);
  EXPECT_LT(step_rad, 1e-7);
  EXPECT_GT(step_rad, 1e-9);
  ASSERT_GT(sweeps.count(), 50u);
  EXPECT_EQ(sweeps.samples.size(), scan.points.size());
  std::vector<int> seen(scan.points.size());
  for (std::size_t s = 0; s < sweeps.count(); ++s) {
    ASSERT_TRUE(s == 0 || sweeps.azimuth_rad[s] > sweeps.azimuth_rad[s - 1]);
    ASSERT_LT(sweeps.begin[s], sweeps.begin[s + 1]);
    for (std::size_t k = sweeps.begin[s]; k < sweeps.begin[s + 1]; ++k) {
      const std::uint32_t sample = sweeps.samples[k];
      ++seen[sample];
      ASSERT_TRUE(k == sweeps.begin[s] || sample > sweeps.samples[k - 1]);
      ASSERT_LE(std::abs(angles.azimuth_rad[sample] - sweeps.azimuth_rad[s]), 0.501 * step_rad);
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ssize(scan.points));
  EXPECT_EQ(stages::recover_columns(scan).samples.size(), scan.points.size());

  for (int k = 0; k < 400; ++k) {  // some are around it
    const auto& [x, y, z] = scan.points[static_cast<std::size_t>(k)];
    scan.points.push_back({x - 5e5f, y - 5e6f + 100, z - 100});
  }
  EXPECT_THROW(stages::recover_columns(scan), Error);
}

TEST(Scattered, samples_in_one_direction_are_one_column) {
  Scan scan;
  scan.scanner_is_known = true;
  scan.points.assign(5000, {2, 2, 2});
  const auto columns = stages::recover_columns(scan);
  EXPECT_EQ(columns.count(), 1);
  EXPECT_EQ(columns.samples.size(), 5000u);
}

TEST(Scattered, only_a_scanner_that_was_given_is_believed) {
  Scan scan = scattered_box(5000);
  EXPECT_THROW(stages::recover_columns(scan), Error);
  io::place_scanner(scan, Vec3(0.5, 0, 0));
  EXPECT_GT(stages::recover_columns(scan).rows, 30);

  Scan few = scattered_box(10);
  few.scanner_is_known = true;
  try {
    stages::recover_columns(few);
    FAIL() << "ten samples are no scan";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("is it where the scanner stood?"), std::string::npos)
        << error.what();
  }
}

}  // namespace hybrid::testing
