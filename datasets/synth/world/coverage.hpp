#pragma once
#include <array>

#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

// Shares of a planar surface's area, without its openings, that no, exactly one, and at least two photographs
// see; on a grid of 5 cm, coarser on large surfaces. What stands against the surface hides it like anything
// else.
std::array<double, 3> seen_shares(const World&, const Tracer&, const Surface&);

}  // namespace synth
