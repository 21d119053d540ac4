// Hypotheses of a scan's pose, told apart by scans that have one: random rooms seen from three places.
#include "stages/registration/scan_hypotheses.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include "cases/trial_room.hpp"
#include "device.hpp"

namespace hybrid::scan_hypotheses_test {
namespace {

using testing::queue;

constexpr int kSamples = 20000;

// A room, two scans of it that have their poses, and a third.
struct Place {
  struct Seen {
    testing::TrialScan scan;
    std::unique_ptr<stages::IcpScan> icp;
    Seen(const testing::TrialRoom& room, std::uint32_t seed)
        : scan(testing::scan_trial_room(queue(), room, seed, 1)),
          icp(testing::icp_scan_of(queue(), scan, kSamples)) {}
    const Pose& pose() const { return scan.world_from_scan; }
  };
  Seen a, b, scan;
  explicit Place(const char* kind, std::uint32_t seed) : Place(testing::make_trial_room(kind, seed), seed) {}
  Place(const testing::TrialRoom& room, std::uint32_t seed)
      : a(room, seed), b(room, seed + 300), scan(room, seed + 700) {}
  std::vector<stages::PlacedScan> placed() const {
    return {{a.icp.get(), a.pose()}, {b.icp.get(), b.pose()}};
  }
};

Pose shifted(const Pose& pose, const Vec3& by) {
  Pose moved = pose;
  moved.translation += by;
  return moved;
}

// Turned about the vertical through the point.
Pose turned(const Pose& pose, double deg, const Vec3& about) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(deg * kDegree, Vec3::UnitZ()));
  return {pose.scale, turn * pose.rotation, turn * (pose.translation - about) + about};
}

Vec3 middle(const testing::RoomPlan& plan) {
  Vec3 sum = Vec3::Zero();
  for (const Vec2& corner : plan.footprint) sum += Vec3(corner.x(), corner.y(), 0);
  return sum / static_cast<double>(plan.footprint.size());
}

stages::ChosenHypothesis choose(const Place& place, const std::vector<Pose>& hypotheses) {
  return stages::choose_hypothesis(queue(), *place.scan.icp, place.placed(), hypotheses);
}

struct Tally {
  int right = 0, wrong = 0, count = 0;
};

// Over random rooms of three kinds whose half turn fits their walls; `beside`: the right place's own
// hypotheses, a few decimetres beside it along two walls, come with the turned ones, or these alone.
Tally trials(bool beside, int count) {
  Tally tally;
  for (int k = 0; k < count; ++k) {
    const auto seed = static_cast<std::uint32_t>(9000 + k);
    const auto room = testing::make_trial_room(k % 3 == 0 ? "box" : k % 3 == 1 ? "niche" : "hall", seed);
    const Place place(room, seed);
    const Pose truth = place.scan.pose();
    const Vec3 centre = middle(room.proxy_plan);
    std::vector<Pose> hypotheses = {turned(truth, 180, centre), turned(truth, 90, centre)};
    if (beside) hypotheses.insert(hypotheses.begin(), shifted(truth, {0.4, 0, 0}));
    if (beside) hypotheses.push_back(shifted(truth, {0, -0.6, 0}));
    const auto chosen = choose(place, hypotheses);
    ++tally.count;
    if (!chosen.accepted) continue;
    const auto off = difference(truth, chosen.found.icp.world_from_scan);
    const bool right = off.distance_m < 0.003 && off.angle_rad < 0.05 * kDegree;
    ++(right ? tally.right : tally.wrong);
  }
  if (std::getenv("TRIALS"))
    printf("of %d rooms %d right, %d wrong, %d abstain\n", tally.count, tally.right, tally.wrong,
           tally.count - tally.right - tally.wrong);
  return tally;
}

int trial_count() {
  return std::getenv("TRIALS") ? 120 : 9;
}

}  // namespace

TEST(ScanHypotheses, the_place_beside_a_hypothesis_is_found_and_its_rivals_are_ruled_out) {
  const Tally tally = trials(true, trial_count());
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.right, tally.count * 0.8);
}

TEST(ScanHypotheses, wrong_ones_alone_are_not_accepted) {
  EXPECT_EQ(trials(false, trial_count()).wrong, 0);
}

TEST(ScanHypotheses, what_is_said_of_the_chosen_one) {
  const auto room = testing::make_trial_room("box", 3);
  const Place place(room, 3);
  const Pose truth = place.scan.pose(), beside = shifted(truth, {0.4, 0, 0});
  const auto chosen = choose(place, {turned(truth, 180, middle(room.proxy_plan)), beside});
  ASSERT_TRUE(chosen.accepted) << chosen.reason;
  EXPECT_EQ(chosen.tried, 2);
  EXPECT_EQ(chosen.start.translation, beside.translation);
  EXPECT_LT(chosen.along, 0.05);
  EXPECT_GT(chosen.held, 0.05);
  EXPECT_EQ(chosen.found.others.size(), 2u);
  EXPECT_GT(chosen.found.icp.overlap, 0.9);
}

// A scan of another room: no hypothesis is right.
TEST(ScanHypotheses, a_scan_of_another_room_is_laid_nowhere) {
  for (const std::uint32_t seed : {3u, 4u, 5u, 6u}) {
    const Place place("box", seed), other("box", seed + 40);
    const Pose at = place.scan.pose();
    const auto chosen =
        stages::choose_hypothesis(queue(), *other.scan.icp, place.placed(),
                                  {at, turned(at, 90, at.translation), turned(at, 180, at.translation)});
    EXPECT_FALSE(chosen.accepted) << seed;
    EXPECT_FALSE(chosen.reason.empty());
  }
}

}  // namespace hybrid::scan_hypotheses_test
