#include "stages/rendering/blend_bands.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {

BlendMode blend_mode(const RenderOptions& options) {
  BlendMode mode{};
  mode.mode = options.blend == "nearest"  ? BLEND_NEAREST
              : options.blend == "linear" ? BLEND_LINEAR
                                          : BLEND_BANDS;
  mode.bands = static_cast<std::uint32_t>(options.blend == "multi-band" ? options.bands : 2);
  for (std::uint32_t band = 0; band + 1 < mode.bands; ++band) {
    const double down = static_cast<double>(mode.bands - 1 - band) / static_cast<double>(mode.bands - 1);
    mode.power[band] = static_cast<std::uint32_t>(std::lround(std::pow(options.high_power, down)));
  }
  return mode;
}

std::vector<double> band_sigmas(const RenderOptions& options) {
  const BlendMode mode = blend_mode(options);
  std::vector<double> sigmas;
  if (mode.mode != BLEND_BANDS) return sigmas;
  for (std::uint32_t band = 0; band + 1 < mode.bands; ++band)
    sigmas.push_back(options.sigma_px * std::exp2(band));
  return sigmas;
}

std::size_t blend_planes(const BlendMode& mode) {
  const std::size_t further = mode.mode == BLEND_BANDS ? mode.bands - 2 : 0;
  return BLEND_PLANES + BLEND_BAND_PLANES * further;
}

}  // namespace hybrid::stages
