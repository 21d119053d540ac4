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
  expect_others_hold(marks, {"/scans/0/pose/translation_mm"});
}

TEST_F(PerfectRoom, a_turned_pose_is_off_in_degrees) {
  Results results = perfect();
  auto& rotation = results.scans[1].world_from_scan.rotation;
  rotation = Eigen::AngleAxisd(M_PI / 180, score::Vec3(1, 2, 3).normalized()).toRotationMatrix() * rotation;
  const auto marks = marks_of(results);
  EXPECT_NEAR(marks["scans"][1]["pose"]["rotation_deg"], 1, 1e-9);
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
  expect_others_hold(marks, {"/scans/0/pose/translation_mm", "/scans/0/pose/status", "/registration/*"});
}

}  // namespace score_tests
