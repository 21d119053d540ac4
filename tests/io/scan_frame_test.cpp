#include "io/scan_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace hybrid::testing {

TEST(ScanFrame, moves_the_origin_to_the_scanner_and_keeps_the_way_back) {
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
TEST(ScanFrame, no_returns_stay_none) {
  Scan scan;
  scan.points = {{0, 0, 0}, {1, 0, 0}};
  io::place_scanner(scan, {5, 0, 0});
  EXPECT_TRUE(std::isnan(scan.points[0][0]));
  EXPECT_EQ(scan.points[1][0], -4.0f);
}

TEST(ScanFrame, an_origin_far_from_the_cloud_is_doubted) {
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

TEST(ScanFrame, contradicts_no_file_that_knows_better) {
  Scan posed;
  posed.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), Vec3(0, 0, 1)};
  EXPECT_THROW(io::place_scanner(posed, {1, 2, 3}), Error);
  posed.points = {{1, 0, 3}};  // in the frame that the pose leads to
  io::place_scanner(posed, {0, 0, 1});
  EXPECT_EQ(posed.points[0], (std::array<float, 3>{1, 0, 2}));
  EXPECT_EQ(posed.world_from_scan->translation, Vec3(0, 0, 1));
  EXPECT_EQ(posed.notes.size(), 1u);
  Scan image;
  image.range_grid.emplace();
  EXPECT_THROW(io::place_scanner(image, {1, 2, 3}), Error);
  Scan plain;
  EXPECT_THROW(io::place_scanner(plain, {1, NAN, 3}), Error);
  plain.world_from_scan = Pose();
  EXPECT_NO_THROW(io::place_scanner(plain, {1, 2, 3}));
}

TEST(ScanFrame, lengths_become_metres) {
  Scan scan;
  scan.origin = Vec3(1000, 0, -500);
  scan.points = {{1, 2, 4}, {NAN, 0, 0}};
  scan.world_from_scan = Pose{1, Eigen::Quaterniond(0, 0, 0, 1), Vec3(10000, 0, 0)};
  io::scale_lengths(scan, io::metres_of_unit("mm"));
  EXPECT_TRUE(scan.point(0).isApprox(Vec3(1.001, 0.002, -0.496), 1e-9));
  EXPECT_TRUE(std::isnan(scan.points[1][0]));
  EXPECT_EQ(scan.world_from_scan->translation, Vec3(10, 0, 0));
  EXPECT_EQ(io::metres_of_unit("m"), 1);
  EXPECT_NEAR(io::metres_of_unit("us-ft") / io::metres_of_unit("ft") - 1, 2e-6, 1e-9);
  EXPECT_THROW(io::metres_of_unit("inch"), Error);
  Scan image;
  image.range_grid.emplace();
  EXPECT_THROW(io::scale_lengths(image, 0.001), Error);
}

// A point 3 m before a camera, 1 m to its right and 2 m above it.
TEST(ScanFrame, axes_of_cameras_become_the_scanners) {
  const Vec3 seen(3, -1, 2);
  for (const auto& [axes, filed] :
       {std::pair{io::ScanAxes::camera, Vec3(1, -2, 3)}, std::pair{io::ScanAxes::opengl, Vec3(1, 2, -3)},
        std::pair{io::ScanAxes::z_up, seen}}) {
    Scan scan;
    scan.origin = filed;
    scan.points = {
        {0, 0, 0},
        {static_cast<float>(filed.x()), static_cast<float>(filed.y()), static_cast<float>(filed.z())}};
    scan.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), Vec3(10, 20, 30)};
    io::turn_axes(scan, axes);
    EXPECT_EQ(scan.point(0), seen);
    EXPECT_EQ(scan.point(1), Vec3(2 * seen));
    EXPECT_TRUE((*scan.world_from_scan * seen).isApprox(filed + Vec3(10, 20, 30), 1e-12));
    EXPECT_TRUE((io::file_from_scanner(axes) * seen).isApprox(filed, 1e-12));
  }
  for (std::size_t k = 0; k < io::kScanAxesNames.size(); ++k)
    EXPECT_EQ(static_cast<std::size_t>(io::scan_axes_of(io::kScanAxesNames[k])), k);
  EXPECT_THROW(io::scan_axes_of("y-up"), Error);
  Scan image;
  image.range_grid.emplace();
  EXPECT_THROW(io::turn_axes(image, io::ScanAxes::camera), Error);
}

}  // namespace hybrid::testing
