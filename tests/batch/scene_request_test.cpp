#include "batch/scene_request.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/pose.hpp"

namespace hybrid::batch {
namespace {

TEST(SceneRequest, a_pose_goes_to_the_scanner_s_frame_and_back) {
  const Pose pose{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), Vec3(4, -5, 6)};
  const Vec3 pick(1, 2, 3);
  for (const auto axes : {io::ScanAxes::z_up, io::ScanAxes::camera, io::ScanAxes::opengl})
    for (const bool scanner : {false, true}) {
      io::SceneScan entry;
      entry.pose = row_major(pose);
      entry.landmarks.emplace_back().scan = pick;
      entry.axes = axes;
      if (scanner) entry.scanner = Vec3(100, 20, -3);
      const io::SceneScan turned = in_scan_frame(entry);
      const Pose inside = pose_from_row_major(*turned.pose);
      EXPECT_EQ(difference(inside, pose).within(1e-9, 1e-9), axes == io::ScanAxes::z_up && !scanner);
      EXPECT_TRUE((inside * *turned.landmarks[0].scan).isApprox(pose * pick, 1e-9));
      EXPECT_TRUE(difference(in_file_frame(entry, inside), pose).within(1e-9, 1e-7)) << scanner;
      Scan scan;  // as the file is read
      scan.points = {{1, 2, 3}};
      if (scanner) io::place_scanner(scan, *entry.scanner);
      io::turn_axes(scan, axes);
      EXPECT_TRUE(scan.point(0).isApprox(*turned.landmarks[0].scan, 1e-6));
    }
}

}  // namespace
}  // namespace hybrid::batch
