// Many places of a scan at once: what is said of them, kept of them, and shown of them.
#include "stages/registration/compare_places.hpp"

#include <gtest/gtest.h>

#include "cases/placed_scans.hpp"
#include "stages/registration/likely_places.hpp"
#include "stages/registration/place_tallies.hpp"

namespace hybrid::compare_places_test {
namespace {

using testing::PlacedScans;
using testing::queue;
using testing::shifted;
using testing::turned;

stages::ScanIcpOptions few() {
  stages::ScanIcpOptions options;
  options.few = true;
  return options;
}

// The right one, more than one launch takes beside it, and one turned.
std::vector<Pose> many_places(const PlacedScans& room) {
  const Pose truth = room.scan.pose();
  std::vector<Pose> places = {truth};
  for (int k = 1; k < 20; ++k) places.push_back(shifted(truth, {0.11 * k, -0.07 * k, 0}));
  places.push_back(turned(truth, 180, truth.translation));
  return places;
}

void expect_same(const stages::PlaceEvidence& a, const stages::PlaceEvidence& b, double tolerance) {
  EXPECT_NEAR(a.seen_through, b.seen_through, tolerance);
  EXPECT_NEAR(a.free_seen_through, b.free_seen_through, tolerance);
  EXPECT_NEAR(a.free_m2, b.free_m2, tolerance * (1 + b.free_m2));
  EXPECT_NEAR((a.planes.on - b.planes.on).norm(), 0, tolerance * b.planes.on.norm());
  EXPECT_NEAR((a.planes.through - b.planes.through).norm(), 0, tolerance * (1 + b.planes.through.norm()));
  EXPECT_NEAR(a.planes.contradicted_m2, b.planes.contradicted_m2, tolerance);
  EXPECT_NEAR(a.planes.beside_m2, b.planes.beside_m2, tolerance);
  EXPECT_NEAR(a.planes.farthest_m, b.planes.farthest_m, tolerance);
}

}  // namespace

TEST(ComparePlaces, says_of_each_what_a_comparison_alone_says) {
  const PlacedScans room("niche", 11);
  const auto places = many_places(room);
  const auto together = stages::compare_places(queue(), *room.scan.icp, room.placed(), places, few());
  ASSERT_EQ(together.size(), places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    SCOPED_TRACE(k);
    expect_same(together[k],
                stages::compare_on_scans(queue(), *room.scan.icp, room.placed(), places[k], few()), 0);
  }
  EXPECT_LT(together.front().seen_through, 0.02);
  EXPECT_GT(together.back().seen_through, 0.05);
}

// One twice as large as the others, of the scene and of a scan.
TEST(ComparePlaces, may_be_of_different_scales) {
  const PlacedScans room("ell", 12);
  std::vector<Pose> places = {room.scan.pose(), room.scan.pose(), room.scan.pose()};
  places[1].scale = 2;
  auto placed = room.placed();
  placed[0].world_from_scan.scale = 1.01;
  const auto together = stages::compare_places(queue(), *room.scan.icp, placed, places, few());
  for (std::size_t k = 0; k < places.size(); ++k) {
    SCOPED_TRACE(k);
    expect_same(together[k], stages::compare_on_scans(queue(), *room.scan.icp, placed, places[k], few()), 0);
  }
  EXPECT_NE(together[0].seen_through, together[1].seen_through);
}

TEST(ComparePlaces, of_none_and_on_none_is_nothing) {
  const PlacedScans room("box", 13);
  EXPECT_TRUE(stages::compare_places(queue(), *room.scan.icp, room.placed(), {}, few()).empty());
  const auto on_none = stages::compare_places(queue(), *room.scan.icp, {}, {room.scan.pose()}, few());
  ASSERT_EQ(on_none.size(), 1u);
  EXPECT_EQ(on_none[0].seen_through, 0);
  EXPECT_EQ(on_none[0].planes.on.norm(), 0);
}

TEST(PlaceTallies, one_more_scan_adds_what_it_says) {
  const PlacedScans room("hall", 14);
  const auto places = many_places(room);
  const auto placed = room.placed();
  stages::PlaceTallies tallies;
  tallies.ask(queue(), *room.scan.icp, {placed[1]}, {places.begin() + 3, places.end()}, few());
  tallies.ask(queue(), *room.scan.icp, placed, places, few());
  for (const Pose& place : places)
    expect_same(tallies.of(place), stages::compare_on_scans(queue(), *room.scan.icp, placed, place, few()),
                1e-6);
}

// As when other scans are the frame: what was said before is of another place.
TEST(PlaceTallies, a_scan_that_has_moved_is_asked_again) {
  const PlacedScans room("hall", 15);
  const std::vector<Pose> places = {room.scan.pose()};
  auto placed = room.placed();
  stages::PlaceTallies tallies;
  tallies.ask(queue(), *room.scan.icp, placed, places, few());
  const double before = tallies.of(places[0]).seen_through;
  placed[1].world_from_scan = turned(placed[1].world_from_scan, 180, room.b.pose().translation);
  tallies.ask(queue(), *room.scan.icp, placed, places, few());
  const auto moved = stages::compare_on_scans(queue(), *room.scan.icp, placed, places[0], few());
  EXPECT_GT(moved.seen_through, before + 0.02);
  expect_same(tallies.of(places[0]), moved, 1e-6);
  placed.pop_back();
  tallies.ask(queue(), *room.scan.icp, placed, places, few());
  expect_same(tallies.of(places[0]),
              stages::compare_on_scans(queue(), *room.scan.icp, placed, places[0], few()), 1e-6);
}

TEST(LikelyPlaces, the_right_one_comes_first_and_each_once) {
  const auto plan = testing::make_trial_room("niche", 16);
  const PlacedScans room(plan, 16);
  const Pose truth = room.scan.pose();
  const auto likely = [&](const std::vector<Pose>& hypotheses, std::size_t most) {
    return stages::likely_places(queue(), *room.scan.icp, room.placed(), hypotheses, most, few(), 0.2);
  };
  const std::vector<Pose> hypotheses = {
      turned(truth, 90, truth.translation), testing::moved_at_random(truth, 0.1, 1, 5),
      testing::moved_at_random(truth, 0.1, 1, 6), turned(truth, 180, testing::middle(plan.proxy_plan))};
  const auto found = likely(hypotheses, 4);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(difference(truth, found[0].icp.world_from_scan).within(0.01, 0.1 * kDegree));
  for (std::size_t k = 1; k < found.size(); ++k) {
    EXPECT_FALSE(difference(truth, found[k].icp.world_from_scan).within(0.3, 3 * kDegree));
    EXPECT_LE(found[k].seen_through, 0.2);
  }
  EXPECT_EQ(likely(hypotheses, 1).size(), 1u);
  // Where nothing but hopeless ones is offered, the best of them is shown.
  EXPECT_EQ(likely({shifted(truth, {2, 1, 0})}, 4).size(), 1u);
  EXPECT_TRUE(stages::likely_places(queue(), *room.scan.icp, {}, hypotheses, 4, few(), 0.2).empty());
}

}  // namespace hybrid::compare_places_test
