#pragma once
#include <array>

#include "room/room.hpp"
#include "trace/tracer.hpp"

namespace synth {

// Shares of a planar surface's area, without its openings, that no, exactly one, and at least two photographs
// see; on a grid of 5 cm. What stands against the surface hides it like anything else.
std::array<double, 3> seen_shares(const Room&, const Tracer&, const Surface&,
                                  const std::vector<Camera>& photographs);

}  // namespace synth
