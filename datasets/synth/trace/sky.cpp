#include "trace/sky.hpp"

#include <algorithm>
#include <cmath>

#include "surface/noise.hpp"

namespace synth {

Rgb sky(const Eigen::Vector3d& direction, bool clouds) {
  static const Rgb zenith(0.16, 0.30, 0.62), horizon(0.62, 0.71, 0.80), haze(0.42, 0.43, 0.42),
      cloud(0.95, 0.95, 0.96);
  if (direction.z() < 0) return haze;
  Rgb colour = blend(horizon, zenith, std::pow(direction.z(), 0.55));
  if (!clouds) return colour * 1.05;  // what the clouds would add
  // A flat layer of clouds: streaks shrink towards the horizon.
  const double height = 1 / (direction.z() + 0.12);
  const double cover =
      fractal_noise(direction.x() * height, direction.y() * height * 1.6, 1.3, 5, 1e-3 * height, 4711);
  return blend(colour, cloud, std::clamp(2.2 * cover - 0.1, 0.0, 0.85) * std::min(1.0, 6 * direction.z()));
}

}  // namespace synth
