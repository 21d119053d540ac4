#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "stages/contours/contour_polygons.hpp"

namespace hybrid::stages::inside_rings_test {
namespace {

// A star of so many vertices around a point, as jagged as contours on noise are, in nanometres.
FlatRing star(std::mt19937& random, int vertices, double x, double y, double radius) {
  std::uniform_real_distribution<double> share(0.5, 1);
  FlatRing ring;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * i / vertices, r = radius * share(random);
    ring.vertices.push_back({std::llround(x + r * std::cos(angle)), std::llround(y + r * std::sin(angle))});
  }
  return ring;
}

// By winding angles: another way than edges that are crossed.
bool winds_around(const FlatRing& ring, const RingVertex& p) {
  double sum = 0;
  for (std::size_t i = 0, j = ring.vertices.size() - 1; i < ring.vertices.size(); j = i++) {
    const RingVertex &a = ring.vertices[j], &b = ring.vertices[i];
    const auto ax = static_cast<double>(a.x - p.x), ay = static_cast<double>(a.y - p.y),
               bx = static_cast<double>(b.x - p.x), by = static_cast<double>(b.y - p.y);
    sum += std::atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return std::abs(sum) > std::numbers::pi;
}

TEST(InsideRings, agree_with_winding_angles) {
  std::mt19937 random(7);
  for (const int vertices : {3, 4, 50, 3000}) {  // below and above the number of bands
    const std::vector<FlatRing> rings = {star(random, vertices, 0, 0, 2e9),
                                         star(random, vertices, 1e8, 5e7, 4e8),
                                         star(random, vertices, 7e9, 1e9, 1e9)};
    const InsideRings inside(rings);
    std::uniform_int_distribution<std::int64_t> x(-3e9, 9e9), y(-3e9, 3e9);
    int within = 0;
    for (int i = 0; i < 2000; ++i) {
      const RingVertex p{x(random), y(random)};
      bool odd = false;
      for (const FlatRing& ring : rings) odd ^= winds_around(ring, p);
      EXPECT_EQ(inside(p), odd) << vertices << " vertices, " << p.x << " " << p.y;
      within += odd;
    }
    EXPECT_GT(within, 50) << vertices;
  }
}

// Where an edge ends and the next begins it is crossed once, on the first and last lines of the rings, too.
TEST(InsideRings, heights_of_vertices_are_no_exception) {
  FlatRing diamond;
  for (const auto& [x, y] : {std::pair{0, -10}, {10, 0}, {0, 10}, {-10, 0}})
    diamond.vertices.push_back({x, y});
  const InsideRings inside({diamond});
  EXPECT_TRUE(inside({0, 0}));
  EXPECT_FALSE(inside({-11, 0}));
  EXPECT_FALSE(inside({11, 0}));
  for (const int y : {-10, 10, -11, 11}) {
    EXPECT_FALSE(inside({-1, y})) << y;
    EXPECT_FALSE(inside({1, y})) << y;
  }
}

TEST(InsideRings, of_nothing_is_nothing) {
  EXPECT_FALSE(InsideRings({})({0, 0}));
  FlatRing flat;  // no height
  for (const int x : {0, 5, 9}) flat.vertices.push_back({x, 3});
  EXPECT_FALSE(InsideRings({flat})({4, 3}));
  EXPECT_FALSE(InsideRings({FlatRing{}})({0, 0}));
}

}  // namespace
}  // namespace hybrid::stages::inside_rings_test
