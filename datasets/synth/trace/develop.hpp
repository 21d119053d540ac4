#pragma once
#include "surface/patterns.hpp"
#include "trace/camera.hpp"
#include "world/options.hpp"

namespace synth {

// What happens between the light on the sensor and the numbers in the file, for one photograph.
struct Development {
  Rgb gain = Rgb::Ones();  // exposure and white balance
  double vignetting = 0;   // light lost in the corners
  bool noise = true;

  double corner_share(const Camera&, double x_px, double y_px) const;  // what vignetting leaves, 0..1
};

// Differs from photograph to photograph by options.photograph_variation.
Development development(const Options&, std::uint64_t photograph);

std::uint8_t encode(double linear);  // sRGB

}  // namespace synth
