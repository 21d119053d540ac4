#pragma once
#include "surface/patterns.hpp"

namespace synth {

// Radiance from the unit direction, without the sun's disc; below the horizon a grey haze. Smooth: without
// clouds, for gathering light.
Rgb sky(const Eigen::Vector3d& direction, bool clouds);

}  // namespace synth
