#pragma once
#include "surface/patterns.hpp"

namespace synth {

Rgb ashlar(const Spot&);         // dressed blocks in even courses, thin joints
Rgb rubble(const Spot&);         // rough stones in mortar, coursed by eye
Rgb dressed_stone(const Spot&);  // tooled, no joints but every half metre
Rgb limewash(const Spot&, double height_m);
Rgb vault_plaster(const Spot&);
Rgb flagstones(const Spot&);
Rgb chancel_tiles(const Spot&);
Rgb cobbles(const Spot&);
Rgb slates(const Spot&);
Rgb marble(const Spot&);
Rgb stained_glass(const Spot&);  // what shines through, leads and all
Rgb outer_glass(const Spot&);

}  // namespace synth
