#pragma once
#include <string>

#include "geometry/flat_ring.hpp"

namespace hybrid {

// What makes a ring no simple polygon with an area, vertex by index and coordinates, and what to do; empty
// where it is one: fewer than three vertices, coordinates that are not finite, one point twice, all on a
// line, an edge that runs back over the one before it, edges that cross.
std::string ring_fault(const Ring2& ring);

}  // namespace hybrid
