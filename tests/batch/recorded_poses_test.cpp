// What is made of poses in scan files before any sample is asked.
#include "batch/registration/recorded_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "device.hpp"

namespace hybrid::batch::recorded_poses_test {
namespace {

Pose at(double x, double turned_rad = 0) {
  return {1, Eigen::Quaterniond(Eigen::AngleAxisd(turned_rad, Vec3::UnitZ())), {x, 0, 0}};
}

struct Survey {
  std::vector<ScanProduct> products;
  Registrations registrations;
  StageOptions options;
  ScanToScan scan_to_scan;
  RecordedPoses recorded;

  explicit Survey(const std::vector<std::optional<Pose>>& poses)
      : products(poses.size()),
        registrations(poses.size()),
        scan_to_scan(testing::queue(), options, products),
        recorded(products, scan_to_scan) {
    for (std::size_t i = 0; i < poses.size(); ++i) products[i].recorded_pose = poses[i];
  }
  void place(std::size_t i, const Pose& world_from_scan) {
    registrations[i].emplace().icp.world_from_scan = world_from_scan;
  }
};

void expect_same(const Pose& a, const Pose& b) {
  const auto apart = difference(a, b);
  EXPECT_LT(apart.distance_m, 1e-9);
  EXPECT_LT(apart.angle_rad, 1e-9);
}

}  // namespace

TEST(RecordedPoses, one_is_the_others_place_and_the_way_between_the_files) {
  const Survey survey({at(4e5, 0.3), at(4e5 + 10, 0.5)});
  const Pose world = at(7, -1);
  const auto pose = survey.recorded.pose_by(1, 0, world);
  ASSERT_TRUE(pose);
  expect_same(*pose, world * (at(4e5, 0.3).inverse() * at(4e5 + 10, 0.5)));
  EXPECT_NEAR((pose->translation - world.translation).norm(), 10, 1e-9);
}

TEST(RecordedPoses, files_without_one_or_with_the_same_say_nothing) {
  const Survey survey({Pose(), Pose(), std::nullopt, at(3)});
  EXPECT_FALSE(survey.recorded.pose_by(1, 0, Pose()));
  EXPECT_FALSE(survey.recorded.pose_by(2, 0, Pose()));
  EXPECT_FALSE(survey.recorded.pose_by(0, 2, Pose()));
  EXPECT_TRUE(survey.recorded.pose_by(3, 0, Pose()));
}

TEST(RecordedPoses, a_start_comes_from_the_nearest_scan_that_has_a_pose_and_does_not_slide) {
  Survey survey({at(0), at(1), at(5), at(9)});
  EXPECT_FALSE(survey.recorded.start_of(0, survey.registrations));
  survey.place(2, at(5.01));
  survey.place(3, at(9.02));
  auto start = survey.recorded.start_of(0, survey.registrations);
  ASSERT_TRUE(start);
  EXPECT_EQ(start->by, 2u);
  expect_same(start->world_from_scan, at(0.01));
  survey.place(1, at(1.03));
  survey.registrations[1]->icp.only_slide = Vec3::UnitX();
  EXPECT_EQ(survey.recorded.start_of(0, survey.registrations)->by, 2u);
  survey.registrations[1]->icp.only_slide.reset();
  EXPECT_EQ(survey.recorded.start_of(0, survey.registrations)->by, 1u);
}

TEST(RecordedPoses, there_is_no_start_where_most_scans_lead_elsewhere) {
  Survey survey({at(0), at(1), at(5), at(9)});
  survey.place(1, at(3));
  survey.place(2, at(5));
  EXPECT_FALSE(survey.recorded.start_of(0, survey.registrations));  // one word against another
  survey.place(3, at(9));
  EXPECT_FALSE(survey.recorded.start_of(0, survey.registrations));
  survey.place(1, at(1));
  survey.place(3, at(12));
  EXPECT_TRUE(survey.recorded.start_of(0, survey.registrations));
}

TEST(RecordedPoses, nobody_trusts_files_whose_scans_have_nothing_to_say) {
  Survey survey({at(0), at(1)});
  survey.products[0].recorded_pose.reset();
  EXPECT_FALSE(survey.recorded.word().is_trusted());
  EXPECT_EQ(survey.recorded.word().differ, 0u);
  EXPECT_FALSE(survey.recorded.trusted_start_of(0, survey.registrations));
}

TEST(RecordedWord, is_trusted_where_five_agree_for_each_that_differs) {
  EXPECT_FALSE(RecordedWord{}.is_trusted());
  EXPECT_TRUE((RecordedWord{1, 0}.is_trusted()));
  EXPECT_FALSE((RecordedWord{4, 1}.is_trusted()));
  EXPECT_TRUE((RecordedWord{5, 1}.is_trusted()));
  EXPECT_FALSE((RecordedWord{9, 2}.is_trusted()));
}

// A turn about the world's origin moves a scanner that stands far from it, one about the scanner does not.
TEST(RecordedWord, its_covariance_is_that_of_turns_about_the_scanner) {
  const RecordedWord word{3, 0, 0.004, 0.002};
  const auto values = word.covariance(at(50));
  const Eigen::Map<const Eigen::Matrix<double, 6, 6>> covariance(values.data());
  // What a point there is moved by: shift and turn cross place.
  const auto moves = [&](const Vec3& place) -> Mat3 {
    Eigen::Matrix<double, 3, 6> of = Eigen::Matrix<double, 3, 6>::Zero();
    for (int k = 0; k < 3; ++k) of.col(k) = Vec3::Unit(k).cross(place);
    of.rightCols(3) = Mat3::Identity();
    return of * covariance * of.transpose();
  };
  EXPECT_LT((moves({50, 0, 0}) - 0.004 * 0.004 * Mat3::Identity()).norm(), 1e-12);
  EXPECT_NEAR(moves({60, 0, 0})(1, 1), 0.004 * 0.004 + 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(moves({60, 0, 0})(0, 0), 0.004 * 0.004, 1e-12);
}

}  // namespace hybrid::batch::recorded_poses_test
