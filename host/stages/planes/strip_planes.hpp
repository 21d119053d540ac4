#pragma once
#include <cstdint>
#include <vector>

#include "stages/planes/square_planes.hpp"

namespace hybrid::stages {

// Planes of strips of height x width samples, as squares have them (their `square` is the longer side), by
// least squares of the measured samples with label 0. Where a strip is not mostly such samples, or they
// scatter by more than their noise, it is not planar. Along a pipe that is narrower than a few squares strips
// are flat where squares are not, and see it turn. `squares` say what the noise is.
SquarePlanes fit_strips(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                        const SquarePlanes& squares, int height, int width);

}  // namespace hybrid::stages
