#include "stages/contours/straight_contours.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/contours/contours.hpp"
#include "stages/contours/simple_rings.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing::straight_contours_test {
namespace {

struct Traced {
  RoomScan scan;
  PlaneSegmentation before, after;

  explicit Traced(const BoxRoom& room) : scan(scan_room(room)) {
    before = stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, room.noise_m), {});
    stages::trace_contours(queue(), scan.image, before);
    after = before;
    stages::straighten_contours(scan.image, stages::find_intersections(scan.image, before), after);
  }
};

std::vector<stages::FlatRing> flat(const Supercluster& supercluster) {
  const stages::PlaneCoordinates coordinates(supercluster.plane);
  std::vector<stages::FlatRing> rings;
  for (const ContourRing& contour : supercluster.contours) {
    rings.push_back({{}, contour.outer});
    for (const Vec3& point : contour.points) rings.back().vertices.push_back(coordinates.vertex(point));
  }
  return rings;
}

double area_m2(const Supercluster& supercluster) {
  double sum = 0;
  for (const auto& ring : flat(supercluster)) sum += 0.5e-18 * stages::signed_area2(ring);
  return sum;
}

}  // namespace

// All that bounds the walls of an empty box are its edges. The floor ends below the scanner, where no ray
// goes.
TEST(StraightContours, walls_of_an_empty_room_are_rectangles) {
  BoxRoom room;
  room.column_radius_m = room.panel_m = room.niche_m = 0;
  const Traced traced(room);
  int walls = 0;
  for (std::size_t i = 0; i < traced.after.superclusters.size(); ++i) {
    const Supercluster &rough = traced.before.superclusters[i], &straight = traced.after.superclusters[i];
    if (std::abs(straight.plane.normal.z()) > 0.5) continue;
    ++walls;
    const double truth = (std::abs(straight.plane.normal.x()) > 0.5 ? 5.2 : 6.0) * 2.95;
    ASSERT_EQ(straight.contours.size(), 1u);
    EXPECT_EQ(straight.contours[0].points.size(), 4u);
    EXPECT_NEAR(area_m2(straight), truth, 0.002 * truth);
    EXPECT_GT(std::abs(area_m2(rough) - truth), 0.005 * truth);  // half a sample is missing all around
  }
  EXPECT_EQ(walls, 4);
}

TEST(StraightContours, rings_stay_simple_and_keep_their_planes_area) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    BoxRoom room;
    room.seed = seed;
    room.occluder = true;
    const Traced traced(room);
    std::size_t before = 0, after = 0;
    for (std::size_t i = 0; i < traced.after.superclusters.size(); ++i) {
      const Supercluster &rough = traced.before.superclusters[i], &straight = traced.after.superclusters[i];
      EXPECT_TRUE(stages::are_simple(flat(straight)));
      ASSERT_EQ(straight.contours.size(), rough.contours.size());
      for (std::size_t k = 0; k < rough.contours.size(); ++k) {
        before += rough.contours[k].points.size();
        after += straight.contours[k].points.size();
        for (const Vec3& point : straight.contours[k].points)
          EXPECT_LT(std::abs(straight.plane.distance(point)), 1e-6);
      }
      if (rough.samples < 2000) continue;  // half a sample is much of a narrow face
      EXPECT_GT(area_m2(straight), 0.98 * area_m2(rough));
      EXPECT_LT(area_m2(straight), 1.1 * area_m2(rough));
    }
    EXPECT_LT(2 * after, before);
  }
}

TEST(StraightContours, without_lines_nothing_moves) {
  const Traced traced({});
  PlaneSegmentation segmentation = traced.before;
  stages::straighten_contours(traced.scan.image, {}, segmentation);
  for (std::size_t i = 0; i < segmentation.superclusters.size(); ++i)
    for (std::size_t k = 0; k < segmentation.superclusters[i].contours.size(); ++k)
      EXPECT_EQ(segmentation.superclusters[i].contours[k].points,
                traced.before.superclusters[i].contours[k].points);
}

}  // namespace hybrid::testing::straight_contours_test
