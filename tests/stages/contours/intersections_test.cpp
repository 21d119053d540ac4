#include "stages/contours/intersections.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/parallel.hpp"
#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing::intersections_test {
namespace {

struct Found {
  RoomScan scan;
  PlaneSegmentation segmentation;
  std::vector<stages::Intersection> intersections;

  explicit Found(const BoxRoom& room) : scan(scan_room(room)) {
    segmentation =
        stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, room.noise_m), {});
    intersections = stages::find_intersections(scan.image, segmentation);
  }
  std::uint32_t id(const Vec3& normal, double offset_m) const {
    for (const Supercluster& s : segmentation.superclusters)
      if (s.plane.normal.dot(normal) > 0.999 && std::abs(s.plane.offset_m - offset_m) < 0.01) return s.id;
    return 0;
  }
  std::vector<stages::Intersection> between(std::uint32_t a, std::uint32_t b) const {
    std::vector<stages::Intersection> result;
    for (const auto& segment : intersections)
      if (segment.planes[0] == std::min(a, b) && segment.planes[1] == std::max(a, b))
        result.push_back(segment);
    return result;
  }
};

double distance_to(const stages::Intersection& segment, const Vec3& point) {
  return std::min((segment.from - point).norm(), (segment.to - point).norm());
}

}  // namespace

// East wall at x = 3.4, north at y = 2.3, west at x = -2.6, floor at z = -1.6, ceiling at 1.35.
TEST(Intersections, a_room_has_its_twelve_edges) {
  BoxRoom room;
  room.column_radius_m = 0;
  room.panel_m = 0;
  room.niche_m = 0;
  const Found found(room);
  EXPECT_EQ(found.intersections.size(), 12u);
  for (const auto& segment : found.intersections) {
    EXPECT_NEAR(segment.angle_deg, 90, 0.2);
    EXPECT_GT(segment.samples, 50);  // the least is 73
  }
  const auto floor = found.id({0, 0, 1}, -1.6), north = found.id({0, -1, 0}, -2.3);
  const auto line = found.between(floor, north);
  ASSERT_EQ(line.size(), 1u);
  // To its corners, within two spacings of the floor's samples there (4.4 m away), and a millimetre across.
  EXPECT_LT(distance_to(line[0], {3.4, 2.3, -1.6}), 0.2);
  EXPECT_LT(distance_to(line[0], {-2.6, 2.3, -1.6}), 0.2);
  for (const Vec3& end : {line[0].from, line[0].to})
    EXPECT_LT(std::hypot(end.y() - 2.3, end.z() + 1.6), 0.001);
}

TEST(Intersections, edges_that_stand_out_have_more_than_half_a_turn) {
  BoxRoom room;
  room.niche_m = 0.4;
  const Found found(room);
  const auto wall = found.id({0, 1, 0}, -2.9), back = found.id({0, 1, 0}, -3.3),
             head = found.id({0, 0, -1}, -0.6);
  const auto outside = found.between(wall, head), inside = found.between(back, head);
  ASSERT_EQ(outside.size(), 1u);
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(outside[0].angle_deg, 270, 2);
  EXPECT_NEAR(inside[0].angle_deg, 90, 2);
  EXPECT_NEAR((inside[0].to - inside[0].from).norm(), 1.5, 0.1);  // the niche's width
}

// The post stands before the wall; they meet nowhere.
TEST(Intersections, an_edge_before_a_farther_plane_is_none) {
  BoxRoom room;
  room.occluder = true;
  const Found found(room);
  const auto wall = found.id({0, -1, 0}, -2.3);
  std::set<std::uint32_t> of_room = {found.id({0, 0, 1}, -1.6), found.id({0, 0, -1}, -1.35),
                                     found.id({-1, 0, 0}, -3.4), found.id({1, 0, 0}, -2.6)};
  ASSERT_NE(wall, 0u);
  ASSERT_EQ(of_room.size(), 4u);
  for (const auto& segment : found.intersections) {
    if (segment.planes[0] != wall && segment.planes[1] != wall) continue;
    EXPECT_TRUE(of_room.contains(segment.planes[0]) || of_room.contains(segment.planes[1]));
  }
}

TEST(Intersections, any_thread_count_gives_the_same) {
  const Found found({});
  const int threads = thread_count();
  for (const int count : {1, 2}) {
    set_thread_count(count);
    const auto again = stages::find_intersections(found.scan.image, found.segmentation);
    ASSERT_EQ(again.size(), found.intersections.size());
    for (std::size_t i = 0; i < again.size(); ++i) {
      EXPECT_EQ(again[i].from, found.intersections[i].from);
      EXPECT_EQ(again[i].samples, found.intersections[i].samples);
    }
  }
  set_thread_count(threads);
}

TEST(Intersections, nothing_comes_of_nothing) {
  EXPECT_TRUE(stages::find_intersections(RangeImage(), PlaneSegmentation()).empty());
}

}  // namespace hybrid::testing::intersections_test
