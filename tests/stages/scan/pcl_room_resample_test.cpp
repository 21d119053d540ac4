// The real pcl-room scans (skipped where the data are absent): 636 sweeps of uneven length that record 318
// columns twice, sample for sample, six of them while the head had hardly begun to turn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "device.hpp"
#include "io/read_scan.hpp"
#include "places.hpp"
#include "stages/scan/columns.hpp"
#include "stages/scan/resample.hpp"

namespace hybrid::testing {
namespace {

std::filesystem::path room_folder() {
  const char* data = std::getenv("HYBRID_DATA");
  const auto root = data ? std::filesystem::path(data)
                         : std::filesystem::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data";
  return root / "scans" / "pcl-room";
}

}  // namespace

TEST(PclRoomResample, sweeps_are_found_and_no_sample_is_lost) {
  for (const char* name : {"room_scan1.pcd", "room_scan2.pcd"}) {
    const auto file = room_folder() / name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real scans at " << file << "; set HYBRID_DATA";
    SCOPED_TRACE(name);
    const Scan scan = io::read_scan(file, 0);
    const stages::ScanColumns columns = stages::recover_columns(scan);
    EXPECT_EQ(columns.sweeps, 636u);
    EXPECT_EQ(columns.count(), 314);
    EXPECT_EQ(columns.rows, 181);
    EXPECT_TRUE(columns.wraps);
    EXPECT_NEAR(columns.elevation_step_rad, 0.972063 * 3.14159265 / 180, 1e-7);

    const RangeImage image = stages::resample_scan(queue(), scan);
    std::vector<int> uses(scan.points.size());
    for (const auto source : image.source)
      if (source != kNoSource) ++uses[source];
    for (const auto extra : image.extra) ++uses[extra];
    for (const auto duplicate : image.duplicates) ++uses[duplicate];
    EXPECT_EQ(std::count(uses.begin(), uses.end(), 1), static_cast<std::ptrdiff_t>(uses.size()));
    const auto measured = std::count(image.mask.begin(), image.mask.end(), kMeasured);
    EXPECT_GT(static_cast<double>(measured), 0.97 * static_cast<double>(image.count()));
    EXPECT_NEAR(static_cast<double>(image.duplicates.size()), 0.5 * static_cast<double>(scan.points.size()),
                0.01 * static_cast<double>(scan.points.size()));
  }
}

}  // namespace hybrid::testing
