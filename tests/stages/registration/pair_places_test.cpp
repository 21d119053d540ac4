// Places of one scan on another, and of some on others, told by what is no plane.
#include "stages/registration/pair_places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "geometry/angles.hpp"
#include "stages/registration/island_places.hpp"

namespace hybrid::pair_places_test {
namespace {

using testing::queue;
using Seen = testing::SeenRoom;

constexpr int kSamples = 20000;

// Walls, floor and ceiling stay superclusters; `others`: what stands in the room, too, so that hardly a
// sample is of no plane.
Seen see(const testing::TrialRoom& room, std::uint32_t seed, bool others = false) {
  Seen seen;
  seen.scan = testing::scan_trial_room(queue(), room, seed, 1);
  auto& planes = seen.scan.segmentation;
  const auto bounds = [&](const Supercluster& one) {
    return std::none_of(planes.superclusters.begin(), planes.superclusters.end(), [&](const auto& other) {
      return other.plane.normal.dot(one.plane.normal) > 0.99 &&
             other.plane.distance(Vec3::Zero()) > one.plane.distance(Vec3::Zero()) + 0.2;
    });
  };
  std::vector<Supercluster> kept;
  std::vector<std::uint32_t> new_id(planes.superclusters.size() + 1, 0);
  for (const Supercluster& one : planes.superclusters) {
    if (!others && !bounds(one)) continue;
    kept.push_back(one);
    kept.back().id = new_id[one.id] = static_cast<std::uint32_t>(kept.size());
  }
  planes.superclusters = std::move(kept);
  for (auto& label : planes.sample_label) label = new_id[label];
  seen.icp = testing::icp_scan_of(queue(), seen.scan, kSamples);
  return seen;
}

// About the middle of a room's footprint, by half a turn: of a box its walls lie on each other so.
Pose turned_by_half(const testing::TrialRoom& room, const Pose& pose) {
  Vec2 middle = Vec2::Zero();
  for (const Vec2& corner : room.proxy_plan.footprint) middle += corner / 4;
  Pose half;
  half.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitZ()));
  half.translation = Vec3(2 * middle.x(), 2 * middle.y(), 0);
  return half * pose;
}

int trial_count() {
  return std::getenv("TRIALS") ? 60 : 6;
}

stages::PairPlaces tell(const Seen& a, const Seen& b, const std::vector<Pose>& places) {
  return stages::tell_places(queue(), *b.icp, {a.icp.get(), a.pose()}, places);
}

// Of `island`, in the frame of its first scan, on `placed`, which lie in the room.
std::optional<stages::IslandFit> tell_island(const std::vector<const Seen*>& island,
                                             const std::vector<const Seen*>& placed,
                                             const std::vector<Pose>& places) {
  const Pose frame_from_world = island[0]->pose().inverse();
  std::vector<stages::PlacedScan> moved, on;
  for (const Seen* one : island) moved.push_back({one->icp.get(), frame_from_world * one->pose()});
  for (const Seen* one : placed) on.push_back({one->icp.get(), one->pose()});
  return stages::tell_island_place(queue(), moved, on, places);
}

}  // namespace

TEST(PairPlaces, what_is_no_plane_tells_a_box_from_itself_turned_by_half) {
  const int count = trial_count();
  int told = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(count); ++seed) {
    const auto room = testing::make_trial_room("box", 9100 + seed);
    const Seen a = see(room, 9100 + seed), b = see(room, 9200 + seed);
    const Pose truth = b.pose();
    const Pose near = testing::moved_at_random(truth, 0.01, 0.1, seed), half = turned_by_half(room, truth);
    EXPECT_FALSE(tell(a, b, {half}).fits) << seed;
    EXPECT_TRUE(tell(a, b, {}).open.empty());
    const auto places = tell(a, b, {half, near, truth});
    ASSERT_FALSE(places.open.empty()) << seed;
    const auto off = difference(truth, places.open.front().icp.world_from_scan);
    EXPECT_LT(off.distance_m, 0.003) << seed;
    EXPECT_LT(off.angle_rad, 0.05 * kDegree) << seed;
    told += places.is_told();
  }
  if (std::getenv("TRIALS")) printf("told %d of %d\n", told, count);
  EXPECT_GE(told, count * 0.7);
}

// All is as in the room but that two walls are 7 cm farther apart.
TEST(PairPlaces, a_room_of_nearly_the_same_size_is_another_place) {
  const int count = trial_count();
  int told = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(count); ++seed) {
    const auto room = testing::make_trial_room("box", 9300 + seed);
    double low = 1e9, high = -1e9;
    for (const Vec2& corner : room.proxy_plan.footprint) {
      low = std::min(low, corner.x());
      high = std::max(high, corner.x());
    }
    auto wider = room;
    for (Vec3& vertex : wider.truth.vertices)
      vertex.x() = low + (vertex.x() - low) * (1 + 0.07 / (high - low));
    const Seen a = see(room, 9300 + seed), b = see(room, 9400 + seed), c = see(wider, 9400 + seed);
    told += tell(a, b, {b.pose()}).is_told();
    EXPECT_FALSE(tell(a, c, {c.pose()}).fits) << seed;
  }
  if (std::getenv("TRIALS")) printf("told %d of %d\n", told, count);
  EXPECT_GE(told, count * 0.7);
}

// With hardly a sample of no plane nothing tells.
TEST(PairPlaces, planes_alone_tell_nothing) {
  const auto room = testing::make_trial_room("box", 9500);
  const Seen a = see(room, 9500, true), b = see(room, 9501, true);
  const auto told = tell(a, b, {b.pose()});
  ASSERT_EQ(told.open.size(), 1u);
  EXPECT_LT(told.open.front().free_m2, 0.008 * b.icp->area_m2);
  EXPECT_FALSE(told.fits);
  EXPECT_FALSE(tell_island({&b}, {&a}, {b.pose()}));
}

TEST(IslandPlaces, two_scans_of_a_box_are_told_from_it_turned_by_half) {
  const int count = trial_count();
  int told = 0, turned = 0;
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(count); ++seed) {
    const auto room = testing::make_trial_room("box", 9600 + seed),
               other = testing::make_trial_room("box", 9900 + seed);
    const Seen a = see(room, 9600 + seed), b = see(room, 9700 + seed), c = see(room, 9800 + seed),
               elsewhere = see(other, 9800 + seed);
    const Pose truth = c.pose();
    const Pose near = testing::moved_at_random(truth, 0.01, 0.1, seed), half = turned_by_half(room, truth);
    EXPECT_FALSE(tell_island({&c, &b}, {&a}, {})) << seed;
    turned += tell_island({&c, &b}, {&a}, {half}).has_value();
    EXPECT_FALSE(tell_island({&elsewhere}, {&a, &b}, {truth, half})) << seed;
    const auto found = tell_island({&c, &b}, {&a}, {half, near, truth});
    if (!found) continue;
    ++told;
    const auto off = difference(truth, found->world_from_island);
    EXPECT_LT(off.distance_m, 0.003) << seed;
    EXPECT_LT(off.angle_rad, 0.05 * kDegree) << seed;
    EXPECT_EQ(found->order.size(), 2u);
  }
  if (std::getenv("TRIALS")) printf("told %d, turned %d of %d\n", told, turned, count);
  EXPECT_GE(told, count * 0.5);   // measured 37 of 60
  EXPECT_LE(turned, count / 60);  // alone; beside the right place it is never taken
}

}  // namespace hybrid::pair_places_test
