#include "surface/noise.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/random.hpp"

namespace synth {
namespace {

double value_noise(double x, double y, std::uint64_t key) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - fx), v = ease(y - fy);
  const double low = std::lerp(hash01(i, j, key), hash01(i + 1, j, key), u);
  const double high = std::lerp(hash01(i, j + 1, key), hash01(i + 1, j + 1, key), u);
  return 2 * std::lerp(low, high, v) - 1;
}

}  // namespace

double hash01(std::int64_t i, std::int64_t j, std::uint64_t key) {
  const std::uint64_t h = mix(key ^ (static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15ull) ^
                              (static_cast<std::uint64_t>(j) * 0xc2b2ae3d27d4eb4full));
  return static_cast<double>(h >> 11) * 0x1p-53;
}

double fractal_noise(double x, double y, double wavelength, int octaves, double footprint,
                     std::uint64_t key) {
  double sum = 0, weight = 1, total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    const double visible = std::clamp(wavelength / footprint - 1, 0.0, 1.0);
    if (visible > 0)
      sum += weight * visible *
             value_noise(x / wavelength, y / wavelength, key + static_cast<std::uint64_t>(octave));
    total += weight;
    weight *= 0.5;
    wavelength *= 0.5;
  }
  return sum / total;
}

double cover(double x, double low, double high, double footprint) {
  const double left = std::max(low, x - footprint / 2), right = std::min(high, x + footprint / 2);
  return std::clamp((right - left) / footprint, 0.0, 1.0);
}

double stripes(double x, double period, double width, double footprint) {
  const auto integral = [&](double t) {
    const double cell = std::floor(t / period);
    return cell * width + std::min(t - cell * period, width);
  };
  return (integral(x + footprint / 2) - integral(x - footprint / 2)) / footprint;
}

double inside(double signed_distance, double footprint) {
  return std::clamp(0.5 - signed_distance / footprint, 0.0, 1.0);
}

}  // namespace synth
