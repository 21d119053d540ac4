#pragma once
#include <cstdint>
#include <vector>

#include "geometry/polygon_model.hpp"

namespace hybrid {

// A format that knows only simple rings (OBJ) writes a hole as a "keyhole": the ring walks to the hole along
// an edge, around it and back along the same edge. These two translate between that and Face::holes.

// Splits `face.outer` at edges it walks in both directions; the loop with the largest area becomes the outer
// ring, the others are appended to the holes, turned clockwise where needed. Other rings stay as they are.
void split_keyholes(const PolygonModel& model, Face& face);

// The outer ring with every hole joined to it by a short edge that crosses nothing; vertices at both ends of
// such an edge occur twice. Throws ErrorKind::input naming the face when a hole cannot be reached: rings that
// cross or lie outside.
std::vector<std::uint32_t> keyhole_ring(const PolygonModel& model, const Face& face);

}  // namespace hybrid
