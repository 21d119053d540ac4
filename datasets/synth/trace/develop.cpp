#include "trace/develop.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/random.hpp"

namespace synth {

double Development::corner_share(const Camera& camera, double x_px, double y_px) const {
  if (camera.spherical) return 1;  // it is put together from many pictures
  const double half = std::hypot(camera.width_px, camera.height_px) / 2;
  const double radius = std::hypot(x_px - camera.centre_x_px, y_px - camera.centre_y_px) / half;
  return 1 - vignetting * std::pow(radius, 4.0);
}

Development development(const Options& options, std::uint64_t photograph) {
  Random random(options.seed, purpose::develop, photograph);
  const double v = options.photograph_variation;
  const double exposure = std::exp(0.10 * v * std::clamp(random.normal(), -2.0, 2.0));
  const double warmth = 0.04 * v * std::clamp(random.normal(), -2.0, 2.0);
  return {exposure * Rgb(1 + warmth, 1, 1 - warmth), 0.25 * v, true};
}

std::uint8_t encode(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * s));
}

}  // namespace synth
