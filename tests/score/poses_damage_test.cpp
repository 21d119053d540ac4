#include "marks.hpp"

namespace score_tests {

TEST_F(PerfectRoom, a_moved_pose_is_off_in_millimetres_and_wrong) {
  Results results = perfect();
  results.scans[0].world_from_scan.translation += score::Vec3(0.06, 0, 0.08);
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][0]["pose"]["translation_mm"], 100, 1e-6);
  EXPECT_EQ(marks["scans"][0]["pose"]["wrong"], true);
  EXPECT_EQ(marks["registration"]["wrong"], 1);
  expect_others_hold(marks, {"/scans/0/pose/translation_mm", "/scans/0/pose/wrong", "/registration/*"});
}

TEST_F(PerfectRoom, a_slightly_moved_pose_is_not_wrong) {
  Results results = perfect();
  results.scans[0].world_from_scan.translation.x() += 0.01;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][0]["pose"]["translation_mm"], 10, 1e-6);
  // Both give way: of 10 mm each keeps a half, less what a turn about the middle takes.
  const auto& fit = marks["registration"]["after_common_fit"];
  EXPECT_GT(fit["place_rms_mm"], 2);
  EXPECT_LE(fit["place_rms_mm"], 5 + 1e-6);
  EXPECT_NEAR(fit["moved_mm"], 5, 0.1);
  expect_others_hold(marks, {"/scans/0/pose/translation_mm", "/registration/after_common_fit/*"});
}

TEST_F(PerfectRoom, a_motion_of_all_scans_is_no_error_among_them) {
  Results results = perfect();
  const auto turn = Eigen::AngleAxisd(0.3 * M_PI / 180, score::Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& scan : results.scans) {
    scan.world_from_scan.rotation = turn * scan.world_from_scan.rotation;
    scan.world_from_scan.translation =
        turn * scan.world_from_scan.translation + score::Vec3(0.01, 0.02, 0.02);
  }
  const auto marks = marks_of(results);
  const auto& fit = marks["registration"]["after_common_fit"];
  EXPECT_EQ(fit["scans"], 2);
  EXPECT_NEAR(fit["place_rms_mm"], 0, 1e-6);
  EXPECT_NEAR(fit["rotation_rms_deg"], 0, 1e-6);
  EXPECT_NEAR(fit["moved_deg"], 0.3, 1e-6);
  EXPECT_GT(marks["scans"][0]["pose"]["translation_mm"], 10);
}

// Without a model: the world is the second scan's.
TEST_F(PerfectRoom, poses_in_a_scans_frame_are_compared_in_it) {
  Results results = perfect();
  const score::Similarity frame_from_world = results.scans[1].world_from_scan.inverse();
  for (auto& scan : results.scans) scan.world_from_scan = frame_from_world * scan.world_from_scan;
  EXPECT_EQ(marks_of(results)["registration"]["wrong"], 2);
  results.scans[1].how = "frame";
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["registration"]["in_the_frame_of"], results.scans[1].id);
  EXPECT_EQ(marks["registration"]["right"], 2);
  EXPECT_NEAR(marks["scans"][0]["pose"]["translation_mm"], 0, 1e-6);
  EXPECT_NEAR(marks["scans"][0]["pose"]["rotation_deg"], 0, 1e-6);
  expect_others_hold(marks, {"/registration/in_the_frame_of"});

  results.scans[0].world_from_scan.translation += score::Vec3(0.06, 0, 0.08);
  const auto moved = marks_of(results);
  EXPECT_NEAR(moved["scans"][0]["pose"]["translation_mm"], 100, 1e-6);
  EXPECT_EQ(moved["registration"]["wrong"], 1);
}

TEST_F(PerfectRoom, a_turned_pose_is_off_in_degrees) {
  Results results = perfect();
  auto& rotation = results.scans[1].world_from_scan.rotation;
  rotation = Eigen::AngleAxisd(M_PI / 180, score::Vec3(1, 2, 3).normalized()).toRotationMatrix() * rotation;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][1]["pose"]["rotation_deg"], 1, 1e-9);
  // Half of it each, were it not for the places.
  EXPECT_GT(marks["registration"]["after_common_fit"]["rotation_largest_deg"], 0.5);
  EXPECT_LT(marks["registration"]["after_common_fit"]["rotation_rms_deg"], 0.7);
  expect_others_hold(marks, {"/scans/1/pose/rotation_deg", "/scans/1/pose/wrong", "/registration/*"});
}

TEST_F(PerfectRoom, a_stretched_pose_has_a_scale_error) {
  Results results = perfect();
  results.scans[0].world_from_scan.scale = 1.01;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][0]["pose"]["scale_error"], 0.01, 1e-9);
  EXPECT_EQ(marks["scans"][0]["pose"]["wrong"], true);
  expect_others_hold(marks, {"/scans/0/pose/scale_error", "/scans/0/pose/wrong", "/registration/*"});
}

TEST_F(PerfectRoom, an_abstained_pose_is_counted_apart_and_never_wrong) {
  Results results = perfect();
  results.scans[0].status = "abstained";
  results.scans[0].world_from_scan.translation.y() += 4;
  const auto marks = marks_of(results);
  EXPECT_EQ(marks["scans"][0]["pose"]["wrong"], false);
  EXPECT_EQ(marks["registration"]["abstained"], 1);
  EXPECT_EQ(marks["registration"]["right"], 1);
  EXPECT_EQ(marks["registration"]["wrong"], 0);
  EXPECT_TRUE(marks["registration"]["after_common_fit"].is_null());  // one pose alone
  expect_others_hold(marks, {"/scans/0/pose/translation_mm", "/scans/0/pose/status", "/registration/*"});
}

}  // namespace score_tests
