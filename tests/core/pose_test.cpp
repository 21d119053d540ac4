#include "geometry/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"

namespace hybrid::pose_test {
namespace {

Pose pose(double scale, double angle, const Vec3& axis, const Vec3& translation) {
  return {scale, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())), translation};
}

const Pose kA = pose(2.5, 0.7, {1, 2, 3}, {10, -20, 30});
const Pose kB = pose(0.4, -2.1, {-1, 0.5, 0}, {0.1, 0.2, -0.3});
const Vec3 kPoint(1.5, -2.5, 3.5);

TEST(pose, applies_scale_then_rotation_then_translation) {
  const Pose quarter = pose(2, std::acos(-1.0) / 2, {0, 0, 1}, {10, 20, 30});
  EXPECT_NEAR((quarter * Vec3(1, 0, 0) - Vec3(10, 22, 30)).norm(), 0, 1e-14);
  EXPECT_NEAR((quarter.rotate({1, 0, 0}) - Vec3(0, 1, 0)).norm(), 0, 1e-15);
}

TEST(pose, composes_right_to_left) {
  EXPECT_NEAR((kA * kB * kPoint - kA * (kB * kPoint)).norm(), 0, 1e-13);
}

TEST(pose, inverse_undoes) {
  EXPECT_NEAR((kA.inverse() * (kA * kPoint) - kPoint).norm(), 0, 1e-13);
  EXPECT_NEAR((kA * kA.inverse() * kPoint - kPoint).norm(), 0, 1e-13);
  const Pose same = kA.inverse().inverse();
  EXPECT_NEAR(same.scale, kA.scale, 1e-15);
  EXPECT_NEAR(difference(same, kA).distance_m, 0, 1e-13);
}

TEST(pose, row_major_is_the_matrix_and_reads_back) {
  const auto matrix = row_major(kA);
  for (int row = 0; row < 3; ++row) {
    const std::size_t at = static_cast<std::size_t>(4 * row);
    const double value =
        matrix[at] * kPoint.x() + matrix[at + 1] * kPoint.y() + matrix[at + 2] * kPoint.z() + matrix[at + 3];
    EXPECT_NEAR(value, (kA * kPoint)(row), 1e-13);
  }
  EXPECT_EQ(matrix[15], 1);
  const Pose back = pose_from_row_major(matrix);
  EXPECT_NEAR(back.scale, kA.scale, 1e-14);
  EXPECT_NEAR(difference(back, kA).angle_rad, 0, 1e-7);  // an angle from a cosine near 1
  EXPECT_EQ(back.translation, kA.translation);
}

TEST(pose, difference_is_angle_and_distance) {
  const auto apart = difference(pose(1, 0.3, {0, 0, 1}, {1, 2, 3}), pose(1, -0.2, {0, 0, 1}, {1, 5, 7}));
  EXPECT_NEAR(apart.angle_rad, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(apart.distance_m, 5);
}

TEST(pose, matrices_that_are_no_similarity_are_refused) {
  const auto reason = [](std::size_t at, double value) -> std::string {
    auto matrix = row_major(kA);
    matrix[at] = value;
    try {
      pose_from_row_major(matrix);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "accepted";
  };
  for (std::size_t at = 0; at < 16; ++at) {
    EXPECT_NE(reason(at, NAN).find("finite"), std::string::npos) << at;
    EXPECT_NE(reason(at, INFINITY).find("finite"), std::string::npos) << at;
  }
  EXPECT_NE(reason(13, 0.5).find("last row"), std::string::npos);
  EXPECT_NE(reason(15, 2).find("last row"), std::string::npos);
  EXPECT_NE(reason(0, 2.5 * kA.scale).find("not a rotation"), std::string::npos);
  auto mirrored = row_major(kA);
  for (std::size_t at : {0u, 4u, 8u}) mirrored[at] = -mirrored[at];
  EXPECT_THROW(pose_from_row_major(mirrored), Error);
  EXPECT_THROW(pose_from_row_major({}), Error);
}

}  // namespace
}  // namespace hybrid::pose_test
