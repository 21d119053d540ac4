#include "io/scanner_position.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"

namespace hybrid::testing {

TEST(ScannerPosition, moves_the_origin_to_the_scanner_and_keeps_the_way_back) {
  Scan scan;
  scan.origin = Vec3(500000, 4000000, 100);
  scan.points = {{1, 2, 3}, {NAN, 0, 0}};
  io::place_scanner(scan, {500010, 4000000, 101.5});
  EXPECT_EQ(scan.points[0], (std::array<float, 3>{-9, 2, 1.5}));
  EXPECT_TRUE(std::isnan(scan.points[1][0]));
  EXPECT_TRUE(scan.origin.isZero());
  EXPECT_TRUE((*scan.world_from_scan * scan.point(0)).isApprox(Vec3(500001, 4000002, 103), 1e-12));
}

// Points at the file's origin were no-returns there; they must not become returns far from the scanner.
TEST(ScannerPosition, no_returns_stay_none) {
  Scan scan;
  scan.points = {{0, 0, 0}, {1, 0, 0}};
  io::place_scanner(scan, {5, 0, 0});
  EXPECT_TRUE(std::isnan(scan.points[0][0]));
  EXPECT_EQ(scan.points[1][0], -4.0f);
}

TEST(ScannerPosition, an_origin_far_from_the_cloud_is_doubted) {
  Scan scan;
  scan.points = {{0, 0, 0}, {NAN, 0, 0}, {1, 5, 0}, {2, 7, 1}};
  EXPECT_NE(io::doubt_of_scanner(scan).find("5.1 m away"), std::string::npos) << io::doubt_of_scanner(scan);
  Scan front = scan;  // a wall seen from outside its box
  front.points = {{-4, 5, 0}, {4, 6, 5}};
  EXPECT_EQ(io::doubt_of_scanner(front), "");
  io::place_scanner(scan, {1.5, 4, 0});
  EXPECT_EQ(io::doubt_of_scanner(scan), "");
  EXPECT_EQ(io::doubt_of_scanner(Scan()), "");
}

TEST(ScannerPosition, contradicts_no_file_that_knows_better) {
  Scan posed;
  posed.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), Vec3(0, 0, 1)};
  EXPECT_THROW(io::place_scanner(posed, {1, 2, 3}), Error);
  Scan image;
  image.range_grid.emplace();
  EXPECT_THROW(io::place_scanner(image, {1, 2, 3}), Error);
  Scan plain;
  EXPECT_THROW(io::place_scanner(plain, {1, NAN, 3}), Error);
  plain.world_from_scan = Pose();
  EXPECT_NO_THROW(io::place_scanner(plain, {1, 2, 3}));
}

}  // namespace hybrid::testing
