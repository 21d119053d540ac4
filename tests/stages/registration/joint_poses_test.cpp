// Several scans of one room: aligned to each other without a model, and refined together.
#include "stages/registration/joint_poses.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "stages/contours/contours.hpp"
#include "stages/registration/automatic.hpp"
#include "stages/registration/scan_model.hpp"

namespace hybrid::joint_poses_test {
namespace {

using testing::queue;

struct Seen {
  testing::TrialScan scan;
  stages::ScanEvidence evidence;
  PolygonModel model;
  stages::ModelShapes shapes;
};

// A scan's labels are the truth, its planes are not: refitted to the noisy samples.
void refit(testing::TrialScan& scan) {
  for (auto& one : scan.segmentation.superclusters) {
    const Plane truth = one.plane;
    Vec3 mean = Vec3::Zero();
    Mat3 scatter = Mat3::Zero();
    double count = 0;
    for (const bool second : {false, true})
      for (std::size_t i = 0; i < scan.image.count(); ++i)
        if (scan.segmentation.sample_label[i] == one.id) {
          const Vec3 p = scan.image.point(i);
          if (second)
            scatter += (p - mean) * (p - mean).transpose();
          else
            mean += (p - mean) / ++count;
        }
    if (count < 10) continue;
    Vec3 n = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvectors().col(0);
    if (n.dot(truth.normal) < 0) n = -n;
    one.plane = {n, n.dot(mean)};
  }
}

Seen see(const testing::TrialRoom& room, std::uint32_t seed, double crop = 1) {
  Seen seen;
  seen.scan = testing::scan_trial_room(queue(), room, seed, crop);
  refit(seen.scan);
  stages::trace_contours(queue(), seen.scan.image, seen.scan.segmentation);
  seen.evidence = stages::gather_evidence(seen.scan.image, seen.scan.segmentation, 4000, 1);
  seen.model = stages::model_of_scan(seen.scan.image, seen.scan.segmentation);
  seen.shapes = stages::measure_model(seen.model);
  return seen;
}

stages::AutomaticAlignment align(const Seen& to, const Seen& scan) {
  stages::AutomaticOptions options;
  options.levelled = options.of_scan = true;
  return stages::align_automatically(queue(), scan.evidence, to.model, options);
}

// Root mean square of what the poses are off after one common rigid motion: the first scan's, which is the
// frame, takes no part in the mean of the others.
std::pair<double, double> errors_in_frame_of_first(const std::vector<Seen>& scans,
                                                   const std::vector<Pose>& poses) {
  double shift = 0, turn = 0;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const auto apart = difference(scans[0].scan.world_from_scan.inverse() * scans[i].scan.world_from_scan,
                                  poses[0].inverse() * poses[i]);
    shift += apart.distance_m * apart.distance_m / static_cast<double>(scans.size() - 1);
    turn += apart.angle_rad * apart.angle_rad / static_cast<double>(scans.size() - 1);
  }
  return {std::sqrt(shift), std::sqrt(turn)};
}

}  // namespace

TEST(ScanToScan, two_scans_of_one_room_are_aligned_and_none_wrongly) {
  int accepted = 0, count = 0, best = 0;
  for (const char* kind : {"box", "niche", "hall", "ell", "oblique", "alcoves"})
    for (std::uint32_t seed = 0; seed < (std::getenv("TRIALS") ? 40 : 2); ++seed) {
      const auto room = testing::make_trial_room(kind, 6100 + seed);
      const Seen a = see(room, 6100 + seed), b = see(room, 6900 + seed, seed % 2 ? 0.7 : 1);
      const auto found = align(a, b);
      const auto error =
          difference(a.scan.world_from_scan.inverse() * b.scan.world_from_scan, found.world_from_scan);
      const bool right = error.distance_m < 0.05 && error.angle_rad < 0.5 * kDegree;
      ++count;
      best += right;
      accepted += found.accepted;
      EXPECT_TRUE(right || !found.accepted) << kind << " " << seed << ": " << error.distance_m << " m";
    }
  if (std::getenv("TRIALS")) printf("accepted %d, best right %d of %d\n", accepted, best, count);
  EXPECT_GE(accepted, count / 2);
}

TEST(ScanToScan, scans_of_different_rooms_abstain) {
  int wrong = 0;
  for (const char* kind : {"box", "niche", "hall", "ell", "oblique"})
    for (std::uint32_t seed = 0; seed < (std::getenv("TRIALS") ? 20 : 2); ++seed) {
      const Seen a = see(testing::make_trial_room(kind, 6100 + seed), 6100 + seed),
                 b = see(testing::make_trial_room(kind, 7700 + seed), 7700 + seed, seed % 2 ? 0.7 : 1);
      wrong += align(a, b).accepted;
    }
  EXPECT_EQ(wrong, 0);
}

TEST(JointPoses, six_scans_fall_together_without_a_model) {
  for (const char* kind : {"hall", "ell"}) {
    const auto room = testing::make_trial_room(kind, 6200);
    std::vector<Seen> seen;
    for (std::uint32_t k = 0; k < 6; ++k) seen.push_back(see(room, 6200 + k));
    std::vector<stages::JointScan> scans;
    for (std::size_t k = 0; k < seen.size(); ++k)
      scans.push_back({&seen[k].evidence,
                       &seen[k].shapes,
                       testing::moved_at_random(seen[k].scan.world_from_scan, k ? 0.05 : 0, k ? 0.5 : 0,
                                                77 + static_cast<std::uint32_t>(k)),
                       false,
                       {},
                       0});
    const auto joint = stages::refine_jointly(scans);
    EXPECT_TRUE(joint.converged);
    const auto [shift, turn] = errors_in_frame_of_first(seen, joint.world_from_scan);
    EXPECT_LT(shift, 0.001) << kind;
    EXPECT_LT(turn, 0.005 * kDegree) << kind;
    if (std::getenv("TRIALS")) printf("%s: %.3f mm %.5f deg\n", kind, 1000 * shift, turn / kDegree);
    EXPECT_EQ(row_major(joint.world_from_scan[0]), row_major(scans[0].start));
    EXPECT_EQ(joint.covariance[0], (std::array<double, 36>{}));
    for (std::size_t k = 1; k < seen.size(); ++k) {
      const Eigen::Matrix<double, 6, 6> covariance =
          Eigen::Map<const Eigen::Matrix<double, 6, 6>>(joint.covariance[k].data());
      EXPECT_GT((Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(covariance).eigenvalues()(0)), 0);
      EXPECT_LT(std::sqrt(covariance.diagonal().tail<3>().maxCoeff()), 0.002);
    }
    EXPECT_EQ(joint.pairs.size(), 15u);
    for (const auto& pair : joint.pairs) {
      EXPECT_GT(pair.overlap, 0.3);
      EXPECT_LT(pair.distance_m, 0.002);
      EXPECT_GT(pair.start_distance_m, 0.01);
      EXPECT_GT(pair.strength, 0.1);
      EXPECT_LE(pair.strength, 1);
    }
    // Twice the same bytes.
    const auto again = stages::refine_jointly(scans);
    for (std::size_t k = 0; k < scans.size(); ++k)
      EXPECT_EQ(row_major(again.world_from_scan[k]), row_major(joint.world_from_scan[k]));
  }
}

TEST(JointPoses, a_scan_that_is_known_stays_and_the_one_that_is_not_comes_to_it) {
  const auto room = testing::make_trial_room("ell", 6300);
  std::vector<Seen> seen = {see(room, 6300), see(room, 6301)};
  std::array<double, 36> known{};
  for (std::size_t k = 0; k < 6; ++k) known[7 * k] = 1e-10;
  stages::JointScan a{&seen[0].evidence, &seen[0].shapes, seen[0].scan.world_from_scan, false, known, 0};
  stages::JointScan b{&seen[1].evidence,
                      &seen[1].shapes,
                      testing::moved_at_random(seen[1].scan.world_from_scan, 0.05, 0.5, 5),
                      false,
                      {},
                      0};
  const auto joint = stages::refine_jointly({b, a});
  EXPECT_LT(difference(joint.world_from_scan[1], a.start).distance_m, 5e-4);
  EXPECT_LT(difference(joint.world_from_scan[0], seen[1].scan.world_from_scan).distance_m, 1e-3);
  // What is known of `a` bounds what is known of `b`.
  EXPECT_GT(joint.covariance[0][21], joint.covariance[1][21]);
  EXPECT_LT(joint.covariance[0][21], 1e-4);
  // Each scan has its own, wherever it stands in the list.
  const auto turned = stages::refine_jointly({a, b});
  for (std::size_t k = 0; k < 36; ++k) {
    EXPECT_NEAR(turned.covariance[0][k], joint.covariance[1][k], 1e-6 * joint.covariance[1][21]) << k;
    EXPECT_NEAR(turned.covariance[1][k], joint.covariance[0][k], 1e-6 * joint.covariance[0][21]) << k;
  }
}

TEST(JointPoses, scans_that_share_nothing_stay_where_they_are) {
  std::vector<Seen> seen = {see(testing::make_trial_room("ell", 6300), 6300),
                            see(testing::make_trial_room("hall", 6301), 6301)};
  Pose far = seen[1].scan.world_from_scan;
  far.translation += Vec3(100, 0, 0);
  const auto joint = stages::refine_jointly(
      {{&seen[0].evidence, &seen[0].shapes, seen[0].scan.world_from_scan, false, {}, 0},
       {&seen[1].evidence, &seen[1].shapes, far, false, {}, 0}});
  EXPECT_TRUE(joint.pairs.empty());
  EXPECT_EQ(row_major(joint.world_from_scan[1]), row_major(far));
  EXPECT_TRUE(stages::refine_jointly({}).world_from_scan.empty());
}

}  // namespace hybrid::joint_poses_test
