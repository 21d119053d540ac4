// Scan-to-scan ICP on range images: random rooms from starts that are off.
#include "stages/registration/scan_icp.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "stages/room_scan.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::scan_icp_test {
namespace {

using testing::queue;
using Seen = testing::SeenRoom;

constexpr int kSamples = 20000;

// `planes` false: as if no supercluster were found, all samples are free ones.
Seen see(const testing::TrialRoom& room, std::uint32_t seed, double crop, bool planes) {
  Seen seen;
  seen.scan = testing::scan_trial_room(queue(), room, seed, crop);
  if (!planes) {
    seen.scan.segmentation.superclusters.clear();
    for (auto& label : seen.scan.segmentation.sample_label) label = 0;
  }
  seen.icp = testing::icp_scan_of(queue(), seen.scan, kSamples);
  return seen;
}

struct Tally {
  int converged = 0, count = 0;
  double worst_m = 0, worst_rad = 0;  // of those
  std::vector<double> errors_m;
};

Tally trials(double distance_m, double deg, bool planes, int count) {
  Tally tally;
  const std::vector<const char*> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  for (int k = 0; k < count; ++k) {
    const auto seed = static_cast<std::uint32_t>(8100 + k);
    const auto room = testing::make_trial_room(kinds[static_cast<std::size_t>(k) % kinds.size()], seed);
    const Seen a = see(room, seed, 1, planes), b = see(room, seed + 700, k % 2 ? 0.7 : 1, planes);
    const Pose truth = b.scan.world_from_scan;
    const auto found = stages::register_to_scans(queue(), *b.icp, {{a.icp.get(), a.scan.world_from_scan}},
                                                 testing::moved_at_random(truth, distance_m, deg, seed));
    const auto off = difference(truth, found.icp.world_from_scan);
    ++tally.count;
    if (off.distance_m > 0.02 || off.angle_rad > 0.2 * kDegree) continue;
    ++tally.converged;
    tally.worst_m = std::max(tally.worst_m, off.distance_m);
    tally.worst_rad = std::max(tally.worst_rad, off.angle_rad);
    tally.errors_m.push_back(off.distance_m);
  }
  std::sort(tally.errors_m.begin(), tally.errors_m.end());
  if (std::getenv("TRIALS"))
    printf("%s, %.2f m %.0f deg: %d of %d, median %.2f mm, worst %.2f mm %.4f deg\n",
           planes ? "planes" : "no planes", distance_m, deg, tally.converged, tally.count,
           1000 * tally.errors_m[tally.errors_m.size() / 2], 1000 * tally.worst_m, tally.worst_rad / kDegree);
  return tally;
}

int trial_count() {
  return std::getenv("TRIALS") ? 100 : 6;
}

}  // namespace

TEST(ScanIcp, starts_of_5_cm_and_2_degrees_converge) {
  const auto tally = trials(0.05, 2, true, trial_count());
  EXPECT_GE(tally.converged, tally.count * 0.95);
  EXPECT_LT(tally.worst_m, 0.004);
}

TEST(ScanIcp, starts_of_30_cm_and_10_degrees_converge) {
  const auto tally = trials(0.3, 10, true, trial_count());
  EXPECT_GE(tally.converged, tally.count * 0.9);
}

TEST(ScanIcp, samples_without_planes_converge) {
  const auto tally = trials(0.05, 2, false, trial_count());
  EXPECT_GE(tally.converged, tally.count * 0.95);
}

// A depth camera's image of the room with a pillar, in the frame of io::read_depth_image(): columns go
// against its azimuth.
RangeImage depth_image(const Pose& world_from_scan) {
  constexpr int kRows = 120, kCols = 160;
  constexpr double kFocal = 130;
  testing::Room room;
  for (Vec3* corner : {&room.low, &room.high, &room.pillar_low, &room.pillar_high})
    *corner -= world_from_scan.translation;
  Scan scan;
  scan.grid_rows = kRows;
  scan.grid_cols = kCols;
  scan.row_by_row = true;
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col) {
      const Vec3 ray(1, -(col - 79.5) / kFocal, -(row - 59.5) / kFocal);
      const Vec3 point = room.cast(world_from_scan.rotate(ray)).range_m * ray;
      scan.points.push_back(
          {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())});
    }
  return stages::arrange_grid(scan);
}

TEST(ScanIcp, depth_images_are_laid_on_each_other) {
  const auto looking = [](double yaw_deg, double pitch_deg, const Vec3& eye) {
    return Pose{1,
                Eigen::AngleAxisd(yaw_deg * kDegree, Vec3::UnitZ()) *
                    Eigen::AngleAxisd(pitch_deg * kDegree, Vec3::UnitY()),
                eye};
  };
  const Pose pose_a = looking(12, 8, {-1.5, -0.6, 0.1}), pose_b = looking(20, 12, {-1.2, -0.9, 0.3});
  const RangeImage image_a = depth_image(pose_a), image_b = depth_image(pose_b);
  ASSERT_EQ(image_a.cols, 160);
  const auto scan = [](const RangeImage& image) {
    PlaneSegmentation none;
    none.sample_label.assign(image.count(), 0);
    return std::make_unique<stages::IcpScan>(queue(),
                                             stages::choose_scan_samples(image, none, {}, kSamples, 1), image,
                                             none, std::vector<std::uint8_t>());
  };
  const auto a = scan(image_a), b = scan(image_b);
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const auto found = stages::register_to_scans(queue(), *b, {{a.get(), pose_a}},
                                                 testing::moved_at_random(pose_b, 0.05, 2, seed));
    const auto off = difference(pose_b, found.icp.world_from_scan);
    EXPECT_LT(off.distance_m, 0.001) << seed;
    EXPECT_LT(off.angle_rad, 0.03 * kDegree) << seed;
    EXPECT_GT(found.icp.overlap, 0.5) << seed;
    EXPECT_LT(found.seen_through, 0.02) << seed;
  }
}

// What tells a wrong pose: the scans see through each other's surfaces, or hardly overlap.
TEST(ScanIcp, scans_of_other_rooms_see_through_each_other) {
  const std::vector<const char*> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  for (int k = 0; k < trial_count(); ++k) {
    const auto seed = static_cast<std::uint32_t>(9100 + k);
    const char* kind = kinds[static_cast<std::size_t>(k) % kinds.size()];
    const bool planes = k / 6 % 2 == 0;
    const Seen a = see(testing::make_trial_room(kind, seed), seed, 1, planes),
               b = see(testing::make_trial_room(kind, seed + 500), seed + 700, k % 2 ? 0.7 : 1, planes);
    const auto found = stages::register_to_scans(queue(), *b.icp, {{a.icp.get(), a.scan.world_from_scan}},
                                                 b.scan.world_from_scan);
    if (std::getenv("TRIALS"))
      printf("other %d %s: %d iterations%s, rms %.4f, overlap %.2f, through %.3f\n", k, kind,
             found.icp.iterations, found.icp.converged ? "" : " (open)", found.icp.rms_m, found.icp.overlap,
             found.seen_through);
    EXPECT_GT(found.seen_through, 0.05) << kind << " " << seed;
  }
}

TEST(ScanIcp, an_eighth_of_the_samples_tells_what_all_of_them_do_where_that_is_clear) {
  const std::vector<const char*> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  stages::ScanIcpOptions few;
  few.few = true;
  int right = 0;
  for (int k = 0; k < trial_count(); ++k) {
    const auto seed = static_cast<std::uint32_t>(9300 + k);
    const char* kind = kinds[static_cast<std::size_t>(k) % kinds.size()];
    const bool planes = k / 6 % 2 == 0;
    const auto room = testing::make_trial_room(kind, seed);
    const Seen a = see(room, seed, 1, planes), b = see(room, seed + 700, k % 2 ? 0.7 : 1, planes),
               other = see(testing::make_trial_room(kind, seed + 500), seed + 700, 1, planes);
    const std::vector<stages::PlacedScan> placed = {{a.icp.get(), a.scan.world_from_scan}};
    const Pose truth = b.scan.world_from_scan;
    const auto found = stages::register_to_scans(queue(), *b.icp, placed,
                                                 testing::moved_at_random(truth, 0.3, 10, seed), few);
    const auto off = difference(truth, found.icp.world_from_scan);
    right += off.distance_m < 0.02 && found.seen_through < 0.02;
    EXPECT_GT(
        stages::register_to_scans(queue(), *other.icp, placed, other.scan.world_from_scan, few).seen_through,
        0.05)
        << kind << " " << seed;
  }
  if (std::getenv("TRIALS")) printf("few: %d of %d\n", right, trial_count());
  EXPECT_GE(right, trial_count() * 0.9);
}

// Under the right pose, and of another room.
TEST(ScanIcp, an_eighth_of_that_eighth_tells_right_from_hopeless) {
  const std::vector<const char*> kinds = {"box", "niche", "hall", "ell", "oblique", "alcoves"};
  stages::ScanIcpOptions fewest;
  fewest.fewest = true;
  double most_of_right = 0, least_of_wrong = 1;
  for (int k = 0; k < trial_count(); ++k) {
    const auto seed = static_cast<std::uint32_t>(9700 + k);
    const char* kind = kinds[static_cast<std::size_t>(k) % kinds.size()];
    const auto room = testing::make_trial_room(kind, seed);
    const Seen a = see(room, seed, 1, true), b = see(room, seed + 700, k % 2 ? 0.7 : 1, true),
               other = see(testing::make_trial_room(kind, seed + 500), seed + 700, 1, true);
    const std::vector<stages::PlacedScan> placed = {{a.icp.get(), a.scan.world_from_scan}};
    const auto through = [&](const Seen& of) {
      return stages::compare_on_scans(queue(), *of.icp, placed, of.scan.world_from_scan, fewest).seen_through;
    };
    most_of_right = std::max(most_of_right, through(b));
    least_of_wrong = std::min(least_of_wrong, through(other));
  }
  if (std::getenv("TRIALS")) printf("fewest: right %.3f, wrong %.3f\n", most_of_right, least_of_wrong);
  EXPECT_LT(most_of_right, 0.05);
  EXPECT_GT(least_of_wrong, 0.1);
}

// The scan of another room, a hundred metres away, is no part of what ICP is on, but of what is said.
TEST(ScanIcp, what_does_not_overlap_is_left_out_of_icp) {
  const auto room = testing::make_trial_room("niche", 9800);
  const Seen a = see(room, 9800, 1, true), b = see(room, 10500, 1, true),
             far = see(testing::make_trial_room("ell", 9801), 9801, 1, true);
  Pose away = far.scan.world_from_scan;
  away.translation.x() += 100;
  const stages::PlacedScan near{a.icp.get(), a.scan.world_from_scan};
  const std::vector<stages::PlacedScan> placed = {{far.icp.get(), away}, near};
  const Pose start = testing::moved_at_random(b.scan.world_from_scan, 0.02, 0.2, 3);
  const auto some = stages::near_scans(placed, stages::compare_on_scans(queue(), *b.icp, placed, start));
  ASSERT_EQ(some.size(), 1u);
  EXPECT_EQ(some[0].scan, a.icp.get());
  const auto found = stages::register_to_some(queue(), *b.icp, some, placed, start);
  const auto alone = stages::register_to_scans(queue(), *b.icp, {near}, start);
  EXPECT_EQ(found.icp.world_from_scan.translation, alone.icp.world_from_scan.translation);
  EXPECT_EQ(found.icp.iterations, alone.icp.iterations);
  EXPECT_TRUE(found.icp.converged);
  ASSERT_EQ(found.others.size(), 2u);
  EXPECT_EQ(found.others[0].on_m2, 0);
  EXPECT_EQ(found.others[1].on_m2, alone.others[0].on_m2);
  EXPECT_LT(difference(b.scan.world_from_scan, found.icp.world_from_scan).distance_m, 0.004);
  // On all where none overlaps: nothing moves it there.
  const auto nowhere = stages::register_to_some(queue(), *b.icp, {}, {placed[0]}, start);
  EXPECT_EQ(nowhere.icp.world_from_scan.translation, start.translation);
  EXPECT_EQ(nowhere.icp.overlap, 0);
}

// What comparing leaves out is what is said of the pose; planes are left out where samples of none are
// enough.
TEST(ScanIcp, comparing_says_what_assessing_says_of_the_others) {
  const auto room = testing::make_trial_room("alcoves", 9400);
  const Seen a = see(room, 9400, 1, true), b = see(room, 10100, 1, true), c = see(room, 10800, 0.7, true);
  const std::vector<stages::PlacedScan> placed = {{a.icp.get(), a.scan.world_from_scan},
                                                  {c.icp.get(), c.scan.world_from_scan}};
  const Pose pose = testing::moved_at_random(b.scan.world_from_scan, 0.1, 2, 3);
  const auto all = stages::assess_on_scans(queue(), *b.icp, placed, pose);
  const auto same = [&](const stages::ScanIcp& some) {
    EXPECT_EQ(some.seen_through, all.seen_through);
    EXPECT_EQ(some.free_m2, all.free_m2);
    EXPECT_EQ(some.icp.overlap, all.icp.overlap);
    EXPECT_EQ(some.planes.on, all.planes.on);
    EXPECT_EQ(some.planes.farthest_m, all.planes.farthest_m);
    ASSERT_EQ(some.others.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(some.others[k].on_m2, all.others[k].on_m2);
  };
  EXPECT_GT(all.free_m2, 0);
  EXPECT_GT(all.seen_through, 0);
  EXPECT_GT(all.icp.rms_m, 0);
  same(stages::compare_on_scans(queue(), *b.icp, placed, pose));
  double asked_of = -1;
  const auto answer = [&](bool enough) {
    return stages::compare_on_scans(queue(), *b.icp, placed, pose, {}, [&](const stages::ScanIcp& found) {
      asked_of = found.free_seen_through;
      return enough;
    });
  };
  same(answer(false));
  EXPECT_EQ(asked_of, all.free_seen_through);
  const auto free_alone = answer(true);
  EXPECT_EQ(free_alone.free_seen_through, all.free_seen_through);
  EXPECT_EQ(free_alone.free_m2, all.free_m2);
  EXPECT_TRUE(free_alone.others.empty());
}

TEST(ScanIcp, a_start_far_off_ends_elsewhere_and_is_seen_through) {
  for (int k = 0; k < trial_count(); ++k) {
    const auto seed = static_cast<std::uint32_t>(9500 + k);
    const auto room = testing::make_trial_room(k % 2 ? "ell" : "alcoves", seed);
    const Seen a = see(room, seed, 1, true), b = see(room, seed + 700, k % 2 ? 0.7 : 1, true);
    const Pose truth = b.scan.world_from_scan;
    const auto found = stages::register_to_scans(queue(), *b.icp, {{a.icp.get(), a.scan.world_from_scan}},
                                                 testing::moved_at_random(truth, 2, 50, seed));
    const auto off = difference(truth, found.icp.world_from_scan);
    if (std::getenv("TRIALS"))
      printf("far %d: %.3f m %.2f deg, %d iterations%s, rms %.4f, overlap %.2f, through %.3f\n", k,
             off.distance_m, off.angle_rad / kDegree, found.icp.iterations,
             found.icp.converged ? "" : " (open)", found.icp.rms_m, found.icp.overlap, found.seen_through);
    if (off.distance_m > 0.1) {
      EXPECT_TRUE(found.seen_through > 0.05 || found.icp.overlap < 0.01) << seed;
    }
  }
}

}  // namespace hybrid::scan_icp_test
