// Where along one direction a scan lies on others: random rooms seen from three places.
#include "stages/registration/slide_on_scans.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "cases/trial_room.hpp"
#include "device.hpp"

namespace hybrid::slide_on_scans_test {
namespace {

using testing::queue;

struct Seen {
  testing::TrialScan scan;
  std::unique_ptr<stages::IcpScan> icp;
  Seen(const testing::TrialRoom& room, std::uint32_t seed)
      : scan(testing::scan_trial_room(queue(), room, seed, 1)),
        icp(testing::icp_scan_of(queue(), scan, 20000)) {}
  stages::PlacedScan placed() const { return {icp.get(), scan.world_from_scan}; }
};

Pose shifted(Pose pose, const Vec3& by) {
  pose.translation += by;
  return pose;
}

// Two scans of a room that have their poses, and a third.
struct Place {
  testing::TrialRoom room;
  Seen a, b, scan;
  explicit Place(std::uint32_t seed, const char* kind = "niche")
      : room(testing::make_trial_room(kind, seed)),
        a(room, seed),
        b(room, seed + 300),
        scan(room, seed + 700) {}
  stages::SlideOnScans slide(const Pose& start, const Vec3& direction) const {
    return stages::slide_on_scans(queue(), *scan.icp, {a.placed(), b.placed()}, start, direction);
  }
};

int trial_count() {
  return std::getenv("TRIALS") ? 60 : 6;
}

}  // namespace

TEST(SlideOnScans, the_place_is_found_within_reach) {
  for (int k = 0; k < trial_count(); ++k) {
    const auto seed = static_cast<std::uint32_t>(400 + k);
    const Place place(seed, k % 2 == 0 ? "niche" : "oblique");
    testing::Draw draw(seed, 5);
    const double angle = draw.within(0, 2 * M_PI), off_m = draw.within(-0.25, 0.25);
    const Vec3 direction(std::cos(angle), std::sin(angle), 0);
    const Pose truth = place.scan.scan.world_from_scan;
    const auto found = place.slide(shifted(truth, -off_m * direction), direction);
    ASSERT_TRUE(found.accepted) << seed << ": " << found.reason;
    EXPECT_NEAR(found.shift_m, off_m, 1e-4) << seed;  // these rooms' planes are exact
    EXPECT_LT(found.seen_through(), 0.1) << seed;
    EXPECT_LT(found.elsewhere, 0.25) << seed;
    ASSERT_EQ(found.on_other_m2.size(), 2u);
    EXPECT_NEAR(found.on_other_m2[0] + found.on_other_m2[1], found.on_m2, 1e-9 * found.on_m2);
    EXPECT_GT(found.sigma_m, 0);
    EXPECT_LT(found.sigma_m, 0.001);
  }
}

TEST(SlideOnScans, beyond_its_reach_it_holds_nothing) {
  for (const std::uint32_t seed : {410u, 411u, 412u}) {
    const Place place(seed);
    const auto found = place.slide(shifted(place.scan.scan.world_from_scan, {0.8, 0, 0}), Vec3(1, 0, 0));
    EXPECT_FALSE(found.accepted) << seed << ", " << found.shift_m;
    EXPECT_FALSE(found.reason.empty());
  }
}

TEST(SlideOnScans, scans_that_see_nothing_of_it_hold_nothing) {
  const Place place(420);
  const auto found = stages::slide_on_scans(
      queue(), *place.scan.icp, {{place.a.icp.get(), shifted(place.a.scan.world_from_scan, {500, 0, 0})}},
      place.scan.scan.world_from_scan, Vec3(1, 0, 0));
  EXPECT_FALSE(found.accepted);
  EXPECT_NE(found.reason.find("hardly anything that the other scans see of it bears on that"),
            std::string::npos)
      << found.reason;
}

}  // namespace hybrid::slide_on_scans_test
