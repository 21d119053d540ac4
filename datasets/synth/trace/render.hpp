#pragma once
#include <cstdint>
#include <vector>

#include "room/room.hpp"
#include "trace/tracer.hpp"

namespace synth {

struct Picture8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb;  // sRGB
};

struct RenderOptions {
  std::uint64_t seed = 1, picture_index = 0;
  int samples_per_pixel_side = 2;  // 2: four stratified samples a pixel
  int light_samples = 2;           // per light and pixel sample
  bool sensor_noise = true;
};

// The true room as the camera sees it, no interpolation between photographs involved.
Picture8 render(const Room&, const Tracer&, const Camera&, const RenderOptions&);

}  // namespace synth
