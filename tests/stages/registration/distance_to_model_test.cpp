#include <gtest/gtest.h>

#include <cmath>

#include "cases/recess_room.hpp"
#include "device.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages {
namespace {

using namespace hybrid::testing;

double distance_to_box(const Vec3& p) {
  const Vec3 outside = (-p).cwiseMax(p - Vec3(8, 6, 3)).cwiseMax(0.0);
  if (outside.norm() > 0) return outside.norm();
  return std::min(p.minCoeff(), (Vec3(8, 6, 3) - p).minCoeff());
}

}  // namespace

TEST(DistanceToModel, near_faces_are_counted_as_the_whole_model_has_them) {
  const RecessRoomScan scan = scan_recess_room(301, 602, 0.002);
  const auto all =
      distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, 30);
  std::vector<std::uint8_t> wanted(scan.image.count());
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = i % 3 != 0;
  const std::vector<float> within_m = {0.002f, all[601 * 150 + 100]};  // ends count
  ASSERT_LT(within_m[1], within_m[0]);
  const auto near = near_faces(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, 30,
                               within_m, wanted);
  ASSERT_EQ(near.size(), all.size());
  std::array<std::size_t, 3> found{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int expected = wanted[i] ? (all[i] <= within_m[0]) + (all[i] <= within_m[1]) : 0;
    ASSERT_EQ(near[i], expected) << i;
    ++found[static_cast<std::size_t>(expected)];
  }
  for (const std::size_t count : found) EXPECT_GT(count, 100u);
}

TEST(DistanceToModel, is_the_distance_to_the_walls) {
  const Vec3 shift(1e5, 2e5, 0);
  RecessRoomScan scan = scan_recess_room(90, 181, 0.002, shift);
  scan.image.mask[scan.image.index(5, 7)] = kInterpolated;
  const auto found =
      distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, -1);
  ASSERT_EQ(found.size(), scan.image.count());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (scan.image.mask[i] != kMeasured) {
      EXPECT_TRUE(std::isnan(found[i]));
      continue;
    }
    ASSERT_NEAR(found[i], distance_to_box(scan.world_from_scan * scan.image.point(i) - shift), 1e-5) << i;
  }
  EXPECT_TRUE(std::isnan(found[scan.image.index(5, 7)]));
}

TEST(DistanceToModel, with_normals_a_side_of_a_recess_is_far_from_the_wall_it_touches) {
  const RecessRoomScan scan = scan_recess_room(300, 600, 0);
  const auto any =
      distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, -1);
  const auto compatible =
      distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, 30);
  std::size_t farther = 0;
  for (std::size_t i = 0; i < any.size(); ++i) {
    if (scan.segmentation.sample_label[i] == 0) continue;
    ASSERT_GE(compatible[i], any[i] - 1e-6f);
    const Vec3 p = scan.world_from_scan * scan.image.point(i);
    const bool jamb = p.x() > 8.01 && p.x() < 8.39 && p.z() > 0.01 && (p.y() < 1.001 || p.y() > 2.999);
    if (!jamb) continue;
    ++farther;
    EXPECT_LT(any[i], 0.4f);
    EXPECT_GT(compatible[i], 0.9f);  // the walls y = 0 and y = 6
  }
  EXPECT_GT(farther, 10u);
}

TEST(DistanceToModel, gives_the_same_bits_for_every_work_group_size) {
  const RecessRoomScan scan = scan_recess_room(61, 127, 0.002);
  const auto [a, b] = at_two_work_group_sizes([&] {
    return distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan, 45);
  });
  EXPECT_TRUE(same_bits(a, b));
}

TEST(DistanceToModel, with_a_gate_for_free_samples_all_others_and_what_is_near_are_measured) {
  const RecessRoomScan scan = scan_recess_room(301, 602, 0.002);
  auto distances = [&](double free_gate_m) {
    return signed_distance_to_model(queue(), scan.image, scan.segmentation, scan.proxy, scan.world_from_scan,
                                    30, free_gate_m);
  };
  const auto all = distances(0), gated = distances(0.1);
  std::size_t near = 0, beyond = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (scan.segmentation.sample_label[i] == 0 && std::isnan(gated[i])) {
      EXPECT_FALSE(std::abs(all[i]) < 0.1f) << i;
      beyond += !std::isnan(all[i]);
    } else {
      EXPECT_TRUE(same_bits(std::vector<float>{gated[i]}, std::vector<float>{all[i]})) << i;
      near += scan.segmentation.sample_label[i] == 0;
    }
  }
  EXPECT_GT(near, 10u);
  EXPECT_GT(beyond, 100u);
}

TEST(DistanceToModel, empty_images_give_empty_answers) {
  const RecessRoomScan scan = scan_recess_room(4, 4, 0);
  EXPECT_TRUE(distance_to_model(queue(), make_range_image(0, 0), {}, scan.proxy, Pose{}, 45).empty());
  const auto none = distance_to_model(queue(), make_range_image(1, 1), {}, scan.proxy, Pose{}, 45);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_TRUE(std::isnan(none[0]));
}

}  // namespace hybrid::stages
