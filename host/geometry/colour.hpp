#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hybrid {

// IEC 61966-2-1 (sRGB). Pictures are sRGB, light inside is linear, pictures out are sRGB again.
// Both ways, 0..1, not clamped.
inline double linear_from_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
inline double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
// Linear light of each byte of a picture.
template <typename T>
const std::array<T, 256>& linear_of_bytes() {
  static const auto table = [] {
    std::array<T, 256> light{};
    for (std::size_t byte = 0; byte < light.size(); ++byte)
      light[byte] = static_cast<T>(linear_from_srgb(static_cast<double>(byte) / 255));
    return light;
  }();
  return table;
}
// From which light on a picture's byte is at least 0, 1, .. 255, by the formula above, to the last bit.
class SrgbSteps {
 public:
  SrgbSteps() {
    for (std::size_t byte = 1; byte < from_.size(); ++byte) {
      double below = from_[byte - 1], reached = 1;
      for (double middle = 0.5 * (below + reached); middle > below && middle < reached;
           middle = 0.5 * (below + reached))
        (std::lround(255 * srgb_from_linear(middle)) < static_cast<long>(byte) ? below : reached) = middle;
      from_[byte] = reached;
    }
    std::uint8_t byte = 0;
    for (std::size_t i = 0; i < start_.size(); ++i) {
      while (byte < 255 && from_[byte + std::size_t{1}] <= static_cast<double>(i) / kStarts) ++byte;
      start_[i] = byte;
    }
  }

  // 0..1.
  std::uint8_t byte(double linear) const {
    std::uint8_t byte = start_[static_cast<std::size_t>(linear * kStarts)];
    while (byte < 255 && from_[byte + std::size_t{1}] <= linear) ++byte;
    return byte;
  }

 private:
  static constexpr std::size_t kStarts = 4096;
  std::array<double, 256> from_{};
  std::array<std::uint8_t, kStarts + 1> start_{};  // the byte of i / kStarts
};

// A picture's byte. Values outside [0, 1] are clamped; NaN becomes 0.
inline std::uint8_t srgb_byte_from_linear(double linear) {
  static const SrgbSteps steps;
  return steps.byte(linear > 0 ? std::fmin(linear, 1.0) : 0.0);
}

// A pastel colour per index, sRGB 0..1: hues by the golden ratio, so that neighbours in number differ.
inline std::array<double, 3> pastel_srgb(std::uint32_t index) {
  const double hue = 6 * std::fmod(0.6180339887498949 * index, 1.0);
  std::array<double, 3> rgb{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double turn = std::fmod(hue + 4.0 * static_cast<double>(k), 6.0);  // 0, 4, 2 sixths for R, G, B
    const double wave = std::fmin(std::fmax(std::fabs(turn - 3) - 1, 0.0), 1.0);
    rgb[k] = 0.95 * (0.6 + 0.4 * wave);
  }
  return rgb;
}

}  // namespace hybrid
