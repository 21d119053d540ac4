#pragma once
#include <algorithm>
#include <cstddef>

namespace hybrid {

// Brings light that exceeds white (1) back into a picture without clipping it: up to half of white light
// stays as it is; above, y = k + (x - k) / (1 + c (x - k)), which leaves the knee k with slope 1 and takes
// `white` to 1. A colour's channels are multiplied by what its largest one is, so that its hue stays.
class Shoulder {
 public:
  // Where nothing is lighter than 1 nothing changes.
  explicit Shoulder(double white = 1)
      : bends_(white > 1), bend_(bends_ ? 1 / (1 - kKnee) - 1 / (white - kKnee) : 0) {}

  bool bends() const { return bends_; }

  double level(double light) const {
    if (!bends_ || !(light > kKnee)) return light;
    return kKnee + (light - kKnee) / (1 + bend_ * (light - kKnee));
  }
  // Red, green, blue.
  void apply(float* rgb) const {
    const float largest = std::max({rgb[0], rgb[1], rgb[2]});
    if (!bends_ || !(static_cast<double>(largest) > kKnee)) return;
    const double factor = level(static_cast<double>(largest)) / static_cast<double>(largest);
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = static_cast<float>(factor * static_cast<double>(rgb[k]));
  }

 private:
  static constexpr double kKnee = 0.5;
  bool bends_;
  double bend_;
};

}  // namespace hybrid
