#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid {

// A closed ring in a plane; the first vertex is not repeated at the end.
using Ring2 = std::vector<Vec2>;

// Positive for counter-clockwise.
double signed_area(const Ring2& ring);

// Whether a point lies inside, by the even-odd rule; on the border either.
bool inside(const Ring2& ring, const Vec2& point);

double distance_to_segment(const Vec2& point, const Vec2& from, const Vec2& to);
double distance_to_border(const Ring2& ring, const Vec2& point);

// Bounding box of a ring with at least one vertex.
struct Box2 {
  Vec2 low, high;
};
Box2 box_of(const Ring2& ring);

// The first two edges (by the index of their first vertex) of one ring that meet elsewhere than in the common
// vertex of neighbours; nothing for a simple ring. Repeated vertices count as meeting.
std::optional<std::pair<std::size_t, std::size_t>> self_crossing(const Ring2& ring);

// Whether edges of the two rings meet.
bool borders_meet(const Ring2& a, const Ring2& b);

// The vertices (indices, ascending) that stay when all those nearer than `tolerance` to the line of their
// neighbours that stay are left out (Douglas and Peucker); the ring without the others.
std::vector<std::size_t> vertices_kept(const Ring2& ring, double tolerance);
Ring2 simplified(const Ring2& ring, double tolerance);

}  // namespace hybrid
