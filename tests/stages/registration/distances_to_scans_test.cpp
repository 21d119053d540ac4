// How a scan's samples lie on another scan of the same room.
#include "stages/registration/distances_to_scans.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/trial_room.hpp"
#include "device.hpp"

namespace hybrid {
namespace {

using testing::queue;

constexpr double kReach_m = 0.1, kNormalDeg = 45;

std::unique_ptr<stages::IcpScan> icp_scan(const testing::TrialScan& scan) {
  return std::make_unique<stages::IcpScan>(
      queue(), stages::choose_scan_samples(scan.image, scan.segmentation, {}, 100, 1), scan.image,
      scan.segmentation, std::vector<std::uint8_t>());
}

double median(std::vector<double> values) {
  EXPECT_GT(values.size(), 100u);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// Distances by where the surface faces: up, down, neither.
struct ByDirection {
  std::vector<double> up, down, aside;
  std::size_t none = 0;
};

ByDirection by_direction(const testing::TrialScan& scan, const stages::DistancesToScans& distances) {
  ByDirection result;
  for (std::size_t i = 0; i < distances.image.count(); ++i) {
    if (distances.image.mask[i] != kMeasured || distances.segmentation.sample_label[i] == 0) continue;
    const double d = distances.signed_m[i];
    const auto& plane = scan.segmentation.superclusters[distances.segmentation.sample_label[i] - 1].plane;
    const double z = scan.world_from_scan.rotate(plane.normal).z();
    if (std::isnan(d))
      ++result.none;
    else
      (z > 0.99 ? result.up : z < -0.99 ? result.down : result.aside).push_back(d);
  }
  return result;
}

}  // namespace

TEST(DistancesToScans, tell_sign_and_size_of_what_a_pose_is_off) {
  const auto room = testing::make_trial_room("box", 8100);
  const auto a = testing::scan_trial_room(queue(), room, 8100, 1),
             b = testing::scan_trial_room(queue(), room, 8800, 1);
  const auto of_a = icp_scan(a);
  Pose raised = b.world_from_scan;
  raised.translation.z() += 0.02;
  const auto under = [&](const Pose& pose) {
    return by_direction(b,
                        stages::distances_to_scans(queue(), b.image, b.segmentation, pose,
                                                   {{of_a.get(), a.world_from_scan}}, kReach_m, kNormalDeg));
  };
  const ByDirection right = under(b.world_from_scan), off = under(raised);
  for (const auto* values : {&right.up, &right.down, &right.aside, &off.aside})
    EXPECT_NEAR(median(*values), 0, 0.0005);
  EXPECT_NEAR(median(off.up), 0.02, 0.0005);     // above the floor: before it
  EXPECT_NEAR(median(off.down), -0.02, 0.0005);  // behind the ceiling
  EXPECT_LT(right.none, b.image.count() / 3);    // what the other scan does not see
}

// Another scan 1 m lower shows no surface near the floor; one more, in its place, does.
TEST(DistancesToScans, of_several_scans_the_closest_surface_counts) {
  const auto room = testing::make_trial_room("box", 8100);
  const auto a = testing::scan_trial_room(queue(), room, 8100, 1),
             b = testing::scan_trial_room(queue(), room, 8800, 1);
  const auto of_a = icp_scan(a);
  Pose lower = a.world_from_scan, slightly = a.world_from_scan;
  lower.translation.z() -= 1;
  slightly.translation.z() -= 0.05;
  const auto against = [&](const std::vector<stages::PlacedScan>& others) {
    return stages::distances_to_scans(queue(), b.image, b.segmentation, b.world_from_scan, others, kReach_m,
                                      kNormalDeg);
  };
  EXPECT_LT(by_direction(b, against({{of_a.get(), lower}})).up.size(), 100u);
  EXPECT_NEAR(median(by_direction(b, against({{of_a.get(), slightly}})).up), 0.05, 0.001);
  const auto all = against({{of_a.get(), lower}, {of_a.get(), a.world_from_scan}, {of_a.get(), slightly}});
  EXPECT_NEAR(median(by_direction(b, all).up), 0, 0.0005);
  for (const float d : against({}).signed_m) EXPECT_TRUE(std::isnan(d));
}

TEST(DistancesToScans, large_scans_are_thinned) {
  RangeImage image = make_range_image(1200, 1000);
  PlaneSegmentation segmentation;
  segmentation.sample_label.assign(image.count(), 0);
  image.mask[image.index(1198, 998)] = kMeasured;
  segmentation.sample_label[image.index(1198, 998)] = 7;
  const auto found =
      stages::distances_to_scans(queue(), image, segmentation, Pose(), {}, kReach_m, kNormalDeg);
  ASSERT_EQ(found.image.rows, 600);
  ASSERT_EQ(found.image.cols, 500);
  EXPECT_EQ(found.image.mask.back(), kMeasured);
  EXPECT_EQ(found.segmentation.sample_label.back(), 7u);
}

}  // namespace hybrid
