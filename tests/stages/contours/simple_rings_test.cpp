#include "stages/contours/simple_rings.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "rings_check.hpp"

namespace hybrid::testing::simple_rings_test {
namespace {

stages::FlatRing ring_of(const Polygon& points, bool outer = true) {
  stages::FlatRing ring;
  ring.outer = outer;
  for (const Vec2& p : points)
    ring.vertices.push_back({std::llround(p.x() * 1e9), std::llround(p.y() * 1e9), Vec3(p.x(), p.y(), 0)});
  return ring;
}
Polygon polygon_of(const stages::FlatRing& ring) {
  Polygon points;
  for (const auto& v : ring.vertices) points.push_back(v.point.head<2>());
  return points;
}
Polygon star(int count, double noise, std::uint32_t seed, double radius = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  Polygon points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    points.emplace_back(radius * std::cos(angle) + normal(random), radius * std::sin(angle) + normal(random));
  }
  return points;
}

}  // namespace

TEST(SimpleRings, area_and_plane_coordinates_are_right_handed_from_the_normals_side) {
  const Plane plane{Vec3(0, -1, 0), -2};  // a wall at y = 2, seen from the origin: x to the right, z up
  const stages::PlaneCoordinates coordinates(plane);
  stages::FlatRing ring;
  for (const Vec3& p : {Vec3(0, 2, 0), Vec3(1, 2, 0), Vec3(1, 2, 1), Vec3(0, 2, 1)})
    ring.vertices.push_back(coordinates.vertex(p));
  EXPECT_NEAR(stages::signed_area2(ring), 2e18, 1e10);
}

TEST(SimpleRings, exact_test_agrees_with_brute_force) {
  int simple = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    const Polygon p = star(40, 0.07, seed);
    const bool expected = crossings(p, p) == 0;
    simple += expected;
    EXPECT_EQ(stages::are_simple({ring_of(p)}), expected) << seed;
  }
  EXPECT_GT(simple, 10);
  EXPECT_LT(simple, 190);
}

TEST(SimpleRings, touching_itself_folding_back_and_repeating_are_not_simple) {
  EXPECT_TRUE(stages::are_simple({ring_of({{0, 0}, {2, 0}, {2, 2}, {0, 2}})}));
  EXPECT_FALSE(stages::are_simple({ring_of({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}})}));  // vertex on an edge
  EXPECT_FALSE(stages::are_simple({ring_of({{0, 0}, {2, 0}, {1, 0}, {1, 2}})}));          // runs back
  EXPECT_FALSE(stages::are_simple({ring_of({{0, 0}, {2, 0}, {2, 0}, {1, 2}})}));          // twice the same
  const auto square = ring_of({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
  EXPECT_TRUE(stages::are_simple({square, ring_of({{2, 2}, {3, 2}, {3, 3}})}));     // vertex to vertex
  EXPECT_FALSE(stages::are_simple({square, ring_of({{1, 1}, {3, 1}, {3, 1.5}})}));  // across
}

// Points moved onto a slanted line lie on it but for a nanometre: what lies over each other need not meet.
TEST(SimpleRings, edges_within_reach_of_each_other_touch) {
  const Vec2 along = Vec2(3, 1).normalized(), across(-along.y(), along.x());
  const auto at = [&](double s, double t) -> Vec2 { return s * along + t * across; };
  const auto ring = ring_of({at(0, 0), at(2, 0), at(2, 1), at(0, 1)});
  // Back over its own edge, 2 nm beside it; another ring along it; a corner on it.
  const auto doubled = ring_of({at(0, 0), at(2, 0), at(2, 1), at(1.5, 2e-9), at(1, 2e-9), at(0, 1)});
  const auto beside = ring_of({at(0.5, -2e-9), at(0.5, -1), at(1.5, -1), at(1.5, -2e-9)});
  const auto pointed = ring_of({at(1, -2e-9), at(0.5, -1), at(1.5, -1)});
  const auto clear = ring_of({at(0.5, -1e-6), at(0.5, -1), at(1.5, -1), at(1.5, -1e-6)});
  EXPECT_EQ(stages::touching_rings({doubled}, 10), (std::vector<std::size_t>{0}));
  EXPECT_EQ(stages::touching_rings({clear, ring, beside}, 10), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(stages::touching_rings({ring, pointed}, 10), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(stages::touching_rings({ring, clear}, 10).empty());
  EXPECT_TRUE(stages::touching_rings({ring, ring_of({at(2, 1), at(3, 1), at(3, 2)})}, 10).empty());
}

TEST(SimpleRings, make_simple_drops_only_what_crosses) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    std::vector<stages::FlatRing> rings = {ring_of(star(500, 0.01, seed))};
    stages::make_simple(rings);
    ASSERT_EQ(rings.size(), 1u);
    const Polygon p = polygon_of(rings[0]);
    EXPECT_EQ(crossings(p, p), 0);
    EXPECT_TRUE(stages::are_simple(rings));
    EXPECT_GT(p.size(), 300u);
    EXPECT_NEAR(area(p), std::numbers::pi, 0.1);
  }
  std::vector<stages::FlatRing> clean = {ring_of(star(500, 0, 1))};
  stages::make_simple(clean);
  EXPECT_EQ(clean[0].vertices.size(), 500u);
}

TEST(SimpleRings, hole_that_crosses_its_outer_ring_gives_way) {
  std::vector<stages::FlatRing> rings = {ring_of(star(200, 0, 1)), ring_of(star(60, 0, 1, 0.3), false)};
  std::reverse(rings[1].vertices.begin(), rings[1].vertices.end());
  for (auto& v : rings[1].vertices) {
    v.x += 720'000'000;
    v.point.x() += 0.72;
  }
  stages::make_simple(rings);
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(rings[0].vertices.size(), 200u);
  EXPECT_LT(rings[1].vertices.size(), 60u);
  EXPECT_EQ(crossings(polygon_of(rings[0]), polygon_of(rings[1])), 0);
}

TEST(SimpleRings, hopeless_outer_ring_becomes_its_hull_and_hopeless_hole_goes) {
  Polygon scrambled = star(100, 0, 1);
  std::shuffle(scrambled.begin(), scrambled.end(), std::mt19937(3));
  std::vector<stages::FlatRing> rings = {ring_of(scrambled)};
  stages::make_simple(rings);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].vertices.size(), 100u);
  EXPECT_NEAR(area(polygon_of(rings[0])), area(star(100, 0, 1)), 1e-9);
  rings = {ring_of(scrambled, false)};
  stages::make_simple(rings);
  EXPECT_TRUE(rings.empty());
}

TEST(SimpleRings, nothing_and_degenerate_rings) {
  std::vector<stages::FlatRing> rings;
  stages::make_simple(rings);
  EXPECT_TRUE(stages::are_simple(rings));
  rings = {ring_of({{0, 0}, {1, 0}}), ring_of({{0, 0}, {1, 1}, {2, 2}})};
  stages::make_simple(rings);
  EXPECT_TRUE(rings.empty());
}

}  // namespace hybrid::testing::simple_rings_test
