#include "geometry/ring_fault.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hybrid {
namespace {

std::string at(const Ring2& ring, std::size_t i) {
  return fmt::format("vertex {} at ({:.6g}, {:.6g})", i, ring[i].x(), ring[i].y());
}

// No vertex leaves the line through the first and the farthest from it by more than rounding.
bool on_one_line(const Ring2& ring) {
  const Vec2& far = *std::max_element(ring.begin(), ring.end(), [&](const Vec2& p, const Vec2& q) {
    return (p - ring[0]).squaredNorm() < (q - ring[0]).squaredNorm();
  });
  const double tolerance = 1e-9 * (far - ring[0]).norm();
  return std::all_of(ring.begin(), ring.end(),
                     [&](const Vec2& p) { return distance_to_segment(p, ring[0], far) <= tolerance; });
}

}  // namespace

std::string ring_fault(const Ring2& ring) {
  if (ring.size() < 3) return fmt::format("expected a polygon of at least 3 vertices, found {}", ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i)
    if (!ring[i].allFinite()) return "expected finite coordinates, found " + at(ring, i);
  for (std::size_t i = 0; i < ring.size(); ++i)
    for (std::size_t j = i + 1; j < ring.size(); ++j)
      if (ring[i] == ring[j])
        return fmt::format(
            "expected vertices of their own places, found {} again as vertex {}; remove one of them{}",
            at(ring, i), j, i == 0 && j + 1 == ring.size() ? ": the polygon closes by itself" : "");
  if (on_one_line(ring))
    return fmt::format("expected a polygon with an area, found all {} vertices on one line; move one off it",
                       ring.size());
  const auto edges = self_crossing(ring);
  if (!edges) return "";
  const auto [first, second] = *edges;
  const std::size_t n = ring.size();
  if (second == first + 1 || (second + 1) % n == first)
    return fmt::format(
        "expected a simple polygon, found an edge that runs back over the one before it, at {}; "
        "remove that vertex",
        at(ring, second == first + 1 ? second : first));
  return fmt::format(
      "expected a simple polygon, found one that meets itself: its edges from {} and from {}; correct the "
      "order of its vertices",
      at(ring, first), at(ring, second));
}

}  // namespace hybrid
