#pragma once
#include <cstddef>
#include <vector>

#include "shared/params_blend_photos.h"
#include "stages/rendering/render.hpp"

namespace hybrid::stages {

// The bands that RenderOptions ask for. Photographs are split by Gaussians of sigma_px, twice that, four
// times that ...; each band between two of them mixes by a power of the weights, 1 in the lowest and
// high_power in the highest. Between two photographs whose weights cross, a power p makes the transition 1 /
// p as wide: from band to band in proportion to its wavelength (Burt and Adelson, A multiresolution spline,
// 1983), as far as high_power is 2^(bands - 1). Dual is the case of two bands.
BlendMode blend_mode(const RenderOptions& options);

// Sigmas of the Gaussians in pixels of the photograph, growing; none unless photographs are split.
std::vector<double> band_sigmas(const RenderOptions& options);

// Planes of sums that the kernels keep per point.
std::size_t blend_planes(const BlendMode& mode);

}  // namespace hybrid::stages
