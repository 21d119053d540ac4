#pragma once
#include "surface/patterns.hpp"
#include "world/world.hpp"

namespace synth {

// Paints the picture over the wall's own albedo; outside its frame the wall comes back unchanged.
Rgb paint(const Decor&, const Spot&, const Rgb& wall);

}  // namespace synth
