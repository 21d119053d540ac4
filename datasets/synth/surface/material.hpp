#pragma once
#include "surface/patterns.hpp"

namespace synth {

struct Finish {
  Rgb albedo;
  Rgb emission;  // radiance added whatever the light: daylight behind panes, lamps in the ceiling
};

// What a point of the room looks like averaged over `footprint_m` across the surface: a function of place
// alone.
Finish finish(const Room&, std::uint32_t surface, const Vec3& point, double footprint_m);

}  // namespace synth
