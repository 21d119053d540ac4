#pragma once
#include "surface/patterns.hpp"
#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

struct Finish {
  Rgb albedo;
  Rgb emission;      // radiance added whatever the light: daylight behind panes, lamps in the ceiling
  double gloss = 0;  // share of light mirrored at right angles
};

// What the point looks like averaged over `footprint_m` across the surface: a function of place alone.
Finish finish(const World&, const Hit&, double footprint_m);

// The church's materials; `extent`: width and height of a planar surface in its texture frame.
Rgb church_albedo(const Surface&, const Spot&, const Eigen::Array2d& extent);

}  // namespace synth
