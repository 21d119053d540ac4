#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hybrid {

// IEC 61966-2-1. Values outside [0, 1] are clamped; NaN becomes 0.
inline double srgb_encode(double linear) {
  const double clamped = linear > 0 ? std::min(linear, 1.0) : 0.0;
  return clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1 / 2.4) - 0.055;
}
inline double srgb_decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
inline std::uint8_t srgb_from_linear(double linear) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_encode(linear)));
}

}  // namespace hybrid
