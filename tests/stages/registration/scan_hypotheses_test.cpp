// Hypotheses of a scan's pose, told apart by scans that have one: random rooms seen from three places.
#include "stages/registration/scan_hypotheses.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include "cases/placed_scans.hpp"
#include "device.hpp"

namespace hybrid::scan_hypotheses_test {
namespace {

using testing::middle;
using testing::queue;
using testing::shifted;
using testing::turned;
using Place = testing::PlacedScans;

stages::ChosenHypothesis choose(const Place& place, const std::vector<Pose>& hypotheses) {
  stages::PlaceTallies tallies;
  return stages::choose_hypothesis(queue(), *place.scan.icp, place.placed(), hypotheses, tallies);
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
    stages::PlaceTallies tallies;
    const auto chosen = stages::choose_hypothesis(
        queue(), *other.scan.icp, place.placed(),
        {at, turned(at, 90, at.translation), turned(at, 180, at.translation)}, tallies);
    EXPECT_FALSE(chosen.accepted) << seed;
    EXPECT_FALSE(chosen.reason.empty());
  }
}

}  // namespace hybrid::scan_hypotheses_test
