#pragma once
#include <cstdint>
#include <vector>

#include "trace/develop.hpp"
#include "trace/indirect.hpp"
#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

struct Picture8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> rgb;  // sRGB
};

struct RenderOptions {
  std::uint64_t seed = 1, picture_index = 0;
  int samples_per_pixel_side = 2;  // 2: four stratified samples a pixel
  int light_samples = 2;           // per area light and pixel sample
  Development development;
};

// The true world as the camera sees it, no interpolation between photographs involved. With `indirect` it is
// lit by the sun and the sky, without by area lights and a constant.
Picture8 render(const World&, const Tracer&, const IndirectLight* indirect, const Camera&,
                const RenderOptions&);

}  // namespace synth
