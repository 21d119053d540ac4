#include "stages/registration/tile_icp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/trial_room.hpp"

namespace hybrid::tile_icp_test {
namespace {

// Stars, of `corners` each, one in the other.
PolygonModel star_with_hole(std::uint32_t corners, double width_m) {
  PolygonModel model;
  Face face;
  for (const bool hole : {false, true}) {
    auto& ring = hole ? face.holes.emplace_back() : face.outer;
    for (std::uint32_t k = 0; k < corners; ++k) {
      const double angle = (hole ? -1 : 1) * 2 * M_PI * k / corners;
      const double radius = (hole ? 0.4 : 1) * (k % 2 ? 0.85 : 1) * width_m / 2;
      ring.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.emplace_back(radius * std::cos(angle), 0.3 * radius * std::sin(angle), 1.0);
    }
  }
  model.faces.push_back(face);
  return model;
}

// Side by side: how far a point lies outside a polygon with holes.
double plainly_outside_m(const stages::FaceShape& face, const Vec2& p) {
  bool inside = false;
  double nearest = INFINITY;
  for (const auto& ring : face.rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()], side = b - a;
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        inside = !inside;
      const double at = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + at * side - p).norm());
    }
  return inside ? 0 : nearest;
}

}  // namespace

// Of few corners, and of many that are not a multiple of what is looked at together.
TEST(FaceShape, is_as_far_from_a_point_as_its_nearest_side) {
  for (const std::uint32_t corners : {4u, 7u, 301u}) {
    const auto shapes = stages::measure_model(star_with_hole(corners, 8));
    const stages::FaceShape& face = shapes.faces.front();
    testing::Draw draw(9, corners);
    int inside = 0, outside = 0, in_hole = 0;
    for (int k = 0; k < 4000; ++k) {
      const Vec3 point(draw.within(-5, 5), draw.within(-2, 2), 1);
      const Vec2 foot(face.u.dot(point - face.origin), face.v.dot(point - face.origin));
      const double expected = plainly_outside_m(face, foot), found = face.outside_m(point);
      EXPECT_NEAR(found, expected, 1e-12) << corners << " corners, point " << k;
      ++(found == 0 ? inside : face.box.contains(foot) ? in_hole : outside);
      for (const double most : {0.05, 0.5}) {
        if (expected < most) {
          EXPECT_EQ(face.outside_m(point, most), found);
        } else {
          EXPECT_GE(face.outside_m(point, most), most * (1 - 1e-9));
        }
      }
    }
    EXPECT_GT(std::min({inside, outside, in_hole}), 200);
  }
}

// A ray at the height of corners, and points on them.
TEST(FaceShape, corners_count_once) {
  PolygonModel model;
  Face face;
  for (int k = 0; k < 40; ++k) {  // a saw, all teeth of one height
    face.outer.push_back(static_cast<std::uint32_t>(k));
    model.vertices.emplace_back(k, k % 2, 0);
  }
  face.outer.push_back(40);
  face.outer.push_back(41);
  model.vertices.emplace_back(39, -2, 0);
  model.vertices.emplace_back(0, -2, 0);
  model.faces.push_back(face);
  const auto shapes = stages::measure_model(model);
  const stages::FaceShape& shape = shapes.faces.front();
  for (int k = 0; k < 39; ++k)
    for (const double y : {-2.5, -2.0, -1.0, 0.0, 0.25, 0.5, 1.0, 1.5}) {
      const Vec3 point(k + 0.5, y, 0);
      const Vec2 foot(shape.u.dot(point - shape.origin), shape.v.dot(point - shape.origin));
      EXPECT_EQ(shape.outside_m(point) == 0, plainly_outside_m(shape, foot) == 0) << k << ' ' << y;
      if (y == -1.0) {
        EXPECT_EQ(shape.outside_m(point), 0);
      }
      if (y == 1.5) {
        EXPECT_GT(shape.outside_m(point), 0.4);
      }
    }
}

TEST(FacePlanes, none_that_is_near_is_left_out) {
  testing::Draw draw(5, 1);
  stages::FacePlanes planes;
  std::vector<Plane> all;
  for (int k = 0; k < 101; ++k) {
    const Vec3 normal = Vec3(draw.within(-1, 1), draw.within(-1, 1), draw.within(-1, 1)).normalized();
    all.push_back({normal, draw.within(-3, 3)});
    planes.add(all.back());
  }
  const Vec3 point(0.4, -1.2, 0.7), normal = Vec3(0.3, 1, -0.2).normalized();
  std::vector<std::uint8_t> near;
  planes.mark_near(point, normal, 1.2, 0.5, near);
  ASSERT_EQ(near.size(), all.size());
  int marked = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(near[k] != 0, std::abs(all[k].distance(point)) < 1.2 && all[k].normal.dot(normal) >= 0.5) << k;
    marked += near[k];
  }
  EXPECT_GT(marked, 3);
}

// Two faces back to back, two that lie in each other, and tiles all around.
TEST(TilePairs, starting_from_those_of_another_pose_finds_the_same) {
  PolygonModel model = star_with_hole(40, 8);
  model.faces.push_back(model.faces.front());
  const auto add = [&](double height, double shift) {
    const PolygonModel more = star_with_hole(40, 5);
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    for (Vec3 vertex : more.vertices) model.vertices.push_back(vertex + Vec3(shift, 0, height));
    Face face = more.faces.front();
    for (auto& v : face.outer) v += first;
    for (auto& v : face.holes[0]) v += first;
    model.faces.push_back(face);
  };
  add(0, 1);
  add(0.4, -1);
  const auto shapes = stages::measure_model(model);
  testing::Draw draw(7, 2);
  stages::ScanEvidence scan;
  for (int k = 0; k < 400; ++k) {
    stages::PlaneTile tile;
    tile.normal = Vec3::UnitZ();
    tile.area_m2 = 1;
    tile.centroid = Vec3(draw.within(-5, 5), draw.within(-2, 2), draw.within(0.5, 1.8));
    scan.tiles.push_back(tile);
  }
  Pose moved;
  moved.translation = Vec3(0.3, -0.2, 0.1);
  const auto last = stages::find_tile_pairs(scan, shapes, moved, 1.5);
  const auto fresh = stages::find_tile_pairs(scan, shapes, Pose(), 1.5),
             warm = stages::find_tile_pairs(scan, shapes, Pose(), 1.5, last);
  int paired = 0, changed = 0;
  for (std::size_t t = 0; t < fresh.size(); ++t) {
    EXPECT_EQ(warm[t].face, fresh[t].face) << t;
    EXPECT_EQ(warm[t].height_m, fresh[t].height_m) << t;
    paired += fresh[t].face != nullptr;
    changed += fresh[t].face != last[t].face;
  }
  EXPECT_GT(paired, 200);
  EXPECT_GT(changed, 20);
}

}  // namespace hybrid::tile_icp_test
