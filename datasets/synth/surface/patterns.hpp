#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace synth {

using Rgb = Eigen::Array3d;  // linear

Rgb srgb(unsigned hex);  // 0xRRGGBB -> linear
inline Rgb blend(const Rgb& a, const Rgb& b, double t) {
  return a + (b - a) * t;
}

// Where on a pattern: metres to the right and up, the width of what is averaged, a number that tells copies
// apart.
struct Spot {
  double u, v, footprint;
  std::uint64_t key;
};

// Albedo of each material without what hangs on it. Walls take their height for skirting, dado and frieze.
Rgb planks(const Spot&);
Rgb rug(const Spot&, double width_m, double height_m, const Rgb& floor);
Rgb ceiling_tiles(const Spot&);
Rgb brick(const Spot&);
Rgb panelled_plaster(const Spot&);
Rgb wallpaper(const Spot&);
Rgb tiled_plaster(const Spot&);
Rgb wall_trim(const Spot&, double wall_height_m, const Rgb& wall);
Rgb wood(const Spot&, const Rgb& colour, double plank_width_m);
Rgb painted_wood(const Spot&);
Rgb corridor(const Spot&);
Rgb daylight(const Spot&, double width_m, double height_m);
Rgb door(const Spot&, double width_m, double height_m);  // the knob on the left
Rgb crate(const Spot&, double width_m, double height_m, const Rgb& slats, const Rgb& frame);
Rgb books(const Spot&, double width_m, double height_m);
Rgb cardboard(const Spot&);
Rgb stone(const Spot&);
Rgb glaze(const Spot&, double turn_m);  // turn_m: once around

}  // namespace synth
