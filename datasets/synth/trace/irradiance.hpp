#pragma once
#include <array>

#include "geometry/mesh.hpp"

namespace synth {

// Lambert's sum over the edges of a uniform polygonal source above the receiver's horizon: irradiance over
// (pi times radiance), 0..1, exact and free of noise. Corners counter-clockwise seen from the lit side.
double form_factor(const Vec3& point, const Vec3& normal, const std::array<Vec3, 4>& corners);

}  // namespace synth
