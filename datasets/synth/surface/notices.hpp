#pragma once
#include "surface/patterns.hpp"
#include "world/world.hpp"

namespace synth {

// Things to read, `text` their first line or, parted by '/', all of their lines; the rest of a notice is made
// up, ever smaller, so that sharpness can be read off.
Rgb notice(const Decor&, double u, double v, double footprint);
Rgb plaque(const Decor&, double u, double v, double footprint);   // cut into pale stone
Rgb numbers(const Decor&, double u, double v, double footprint);  // a board with white numbers

}  // namespace synth
