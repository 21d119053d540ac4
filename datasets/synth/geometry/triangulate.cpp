#include <algorithm>
#include <limits>
#include <stdexcept>

#include "geometry/outline.hpp"

namespace synth {
namespace {

using Ring = std::vector<std::uint32_t>;

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Whether the open segments cross or touch; sharing an end does not count.
bool crosses(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  if (a == c || a == d || b == c || b == d) return false;
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

// Whether the way from corner k of a counter-clockwise ring to a point starts inside the ring. Corners at
// which a bridge begins occur twice in it, each with its own share of the inside.
bool starts_inside(const Ring& ring, std::size_t k, const Vec2& to, const std::vector<Vec2>& points) {
  const Vec2 &before = points[ring[(k + ring.size() - 1) % ring.size()]], &corner = points[ring[k]],
             &after = points[ring[(k + 1) % ring.size()]];
  if (turn(before, corner, after) >= 0) return turn(corner, to, before) > 0 && turn(corner, after, to) > 0;
  return turn(corner, to, after) < 0 || turn(corner, before, to) < 0;
}

// Walks from the ring to the hole and back along its shortest bridge that crosses nothing.
void bridge(Ring& ring, const Ring& hole, const std::vector<Ring>& waiting, const std::vector<Vec2>& points) {
  double shortest = std::numeric_limits<double>::max();
  std::size_t from = 0, to = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const Vec2 &a = points[ring[i]], &b = points[hole[j]];
      const double length = (b - a).squaredNorm();
      if (length >= shortest) continue;
      const auto blocked = [&](const Ring& other) {
        for (std::size_t k = 0; k < other.size(); ++k)
          if (crosses(a, b, points[other[k]], points[other[(k + 1) % other.size()]])) return true;
        return false;
      };
      if (!starts_inside(ring, i, b, points)) continue;
      if (blocked(ring) || blocked(hole) || std::any_of(waiting.begin(), waiting.end(), blocked)) continue;
      shortest = length;
      from = i;
      to = j;
    }
  }
  Ring walk(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(from) + 1);
  for (std::size_t k = 0; k <= hole.size(); ++k)  // clockwise: holes come counter-clockwise
    walk.push_back(hole[(to + hole.size() - k) % hole.size()]);
  walk.insert(walk.end(), ring.begin() + static_cast<std::ptrdiff_t>(from), ring.end());
  ring = walk;
}

bool is_ear(const Ring& ring, std::size_t k, const std::vector<Vec2>& points) {
  const Vec2 &a = points[ring[(k + ring.size() - 1) % ring.size()]], &b = points[ring[k]],
             &c = points[ring[(k + 1) % ring.size()]];
  if (turn(a, b, c) <= 1e-12) return false;
  return std::none_of(ring.begin(), ring.end(), [&](std::uint32_t i) {
    const Vec2& p = points[i];
    return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
  });
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Vec2>& outline,
                                                      const std::vector<std::vector<Vec2>>& holes) {
  std::vector<Vec2> points = outline;
  Ring ring;
  for (std::size_t k = 0; k < outline.size(); ++k) ring.push_back(static_cast<std::uint32_t>(k));
  std::vector<Ring> waiting;
  for (const auto& hole : holes) {
    waiting.emplace_back();
    for (const Vec2& p : hole) {
      waiting.back().push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(p);
    }
  }
  while (!waiting.empty()) {
    const Ring hole = waiting.back();
    waiting.pop_back();
    bridge(ring, hole, waiting, points);
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  while (ring.size() > 3) {
    std::size_t ear = 0;
    while (ear < ring.size() && !is_ear(ring, ear, points)) ++ear;
    if (ear == ring.size()) {  // corners on one line are left: clip the flattest
      for (ear = 0; ear < ring.size(); ++ear) {
        const double t = turn(points[ring[(ear + ring.size() - 1) % ring.size()]], points[ring[ear]],
                              points[ring[(ear + 1) % ring.size()]]);
        if (std::abs(t) <= 1e-9) break;
      }
      if (ear == ring.size()) throw std::logic_error("synthetic mesh: an outline crosses itself");
    }
    triangles.push_back(
        {ring[(ear + ring.size() - 1) % ring.size()], ring[ear], ring[(ear + 1) % ring.size()]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
  return triangles;
}

}  // namespace synth
