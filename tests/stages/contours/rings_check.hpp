#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/superclusters.hpp"

namespace hybrid::testing {

// Independent checks of rings in double precision, by brute force.
using Polygon = std::vector<Vec2>;

inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}
inline double area(const Polygon& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += cross(p[i], p[(i + 1) % p.size()]);
  return sum / 2;
}
// Proper crossings only: touching is left to the exact test.
inline bool edges_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) { return cross(q - p, r - p); };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}
inline int crossings(const Polygon& p, const Polygon& q) {
  int count = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = &p == &q ? i + 1 : 0; j < q.size(); ++j)
      count += edges_cross(p[i], p[(i + 1) % p.size()], q[j], q[(j + 1) % q.size()]);
  return count;
}
// Vertices of q on edges of p, but for edges' own ends and, between rings, common vertices.
inline int touches(const Polygon& p, const Polygon& q) {
  constexpr double kNear_m = 2e-9, kSame_m = 1e-12;
  int count = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < q.size(); ++j) {
      const Vec2 &a = p[i], &b = p[(i + 1) % p.size()], &c = q[j];
      if ((&p == &q && (j == i || j == (i + 1) % p.size())) || (c - a).norm() < kSame_m ||
          (c - b).norm() < kSame_m)
        continue;
      const double along = std::clamp((c - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      count += (a + along * (b - a) - c).norm() < kNear_m;
    }
  return count;
}
inline bool contains(const Polygon& polygon, const Vec2& p) {
  bool in = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      in = !in;
  }
  return in;
}
// In coordinates of the plane, right-handed as seen from the normal's side.
inline Polygon flatten(const Plane& plane, const ContourRing& ring) {
  const Vec3 x = plane.normal.unitOrthogonal(), y = plane.normal.cross(x);
  Polygon flat;
  for (const Vec3& p : ring.points) flat.emplace_back(x.dot(p), y.dot(p));
  return flat;
}

// Points on the plane, outer rings counter-clockwise, inner ones clockwise and inside an outer one, no
// crossings. Returns the area inside.
inline double expect_valid_contours(const Supercluster& s) {
  std::vector<Polygon> flat;
  double inside = 0;
  for (const ContourRing& ring : s.contours) {
    EXPECT_GE(ring.points.size(), 3u);
    for (const Vec3& p : ring.points) EXPECT_NEAR(s.plane.distance(p), 0, 1e-9);
    flat.push_back(flatten(s.plane, ring));
    EXPECT_EQ(area(flat.back()) > 0, ring.outer);
    inside += area(flat.back());
  }
  for (std::size_t i = 0; i < flat.size(); ++i) {
    bool held = s.contours[i].outer;
    for (std::size_t j = 0; j < flat.size(); ++j) {
      if (j >= i) {
        EXPECT_EQ(crossings(flat[i], flat[j]), 0) << "supercluster " << s.id << " rings " << i << " " << j;
      }
      EXPECT_EQ(touches(flat[i], flat[j]), 0) << "supercluster " << s.id << " rings " << i << " " << j;
      // The middle of an edge: a vertex may touch the outer ring.
      held = held || (s.contours[j].outer && contains(flat[j], (flat[i][0] + flat[i][1]) / 2));
    }
    EXPECT_TRUE(held) << "supercluster " << s.id << " ring " << i;
  }
  return inside;
}

}  // namespace hybrid::testing
