#include "batch/scene_request.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/pose.hpp"

namespace hybrid::batch {
namespace {

TEST(SceneRequest, a_pose_goes_to_the_scanner_s_frame_and_back) {
  const Pose pose{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), Vec3(4, -5, 6)};
  for (const bool depth : {false, true})
    for (const bool scanner : {false, true}) {
      io::SceneScan entry;
      entry.pose = row_major(pose);
      if (depth) entry.depth.emplace();
      if (scanner) entry.scanner = Vec3(100, 20, -3);
      const Pose inside = pose_from_row_major(*in_scan_frame(entry).pose);
      EXPECT_EQ(difference(inside, pose).within(1e-9, 1e-9), !depth && !scanner);
      EXPECT_TRUE(difference(in_file_frame(entry, inside), pose).within(1e-9, 1e-7)) << depth << scanner;
    }
}

}  // namespace
}  // namespace hybrid::batch
