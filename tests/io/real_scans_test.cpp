#include <gtest/gtest.h>

#include "io/files.hpp"
#include "io/read_scan.hpp"
#include "io/scan_info.hpp"

namespace hybrid::testing {
namespace {

// The scanner of the rooms stands at the origin, in a hall of 29 x 14 x 3 m.
TEST(RealScansInDetail, RoomExtents) {
  const auto file = real_data("scans/pcl-room/room_scan1.pcd");
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs scans/pcl-room under ../shared/data or HYBRID_DATA";
  const io::ScanInfo info = io::read_scan_info(file).at(0);
  const Vec3 extent = info.max_m - info.min_m;
  EXPECT_NEAR(extent.x(), 29, 1);
  EXPECT_NEAR(extent.y(), 14, 1);
  EXPECT_NEAR(extent.z(), 3, 0.5);
}

// An organised scan of flat walls: neighbours on the grid must be neighbours in space, along both directions.
TEST(RealScansInDetail, GridNeighboursAreClose) {
  const auto file = real_data("planes/synpeb/test_100.pcd");
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs planes/synpeb under ../shared/data or HYBRID_DATA";
  const Scan scan = io::read_scan(file, 0);
  const auto direction = [&](int row, int col) {
    const auto& p = scan.points[scan.grid_index(row, col)];
    return Vec3(Vec3(p[0], p[1], p[2]).normalized());
  };
  for (int i = 0; i + 1 < 100; ++i) {
    EXPECT_LT((direction(i + 1, 50) - direction(i, 50)).norm(), 0.05);
    EXPECT_LT((direction(50, i + 1) - direction(50, i)).norm(), 0.05);
  }
}

}  // namespace
}  // namespace hybrid::testing
