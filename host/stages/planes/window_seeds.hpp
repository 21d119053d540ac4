#pragma once
#include <cstdint>
#include <vector>

#include "device/queue.hpp"
#include "stages/planes/plane_floods.hpp"

namespace hybrid::stages {

// Windows of a few free samples (SampleUse per sample in `use`) most of which lie on a plane as noise
// explains, tile by tile: what tries them sorts. Kernel: window_planes.
std::vector<WindowSeed> find_window_seeds(device::Queue& queue, const RangeImage& image,
                                          const std::vector<std::uint8_t>& use, const RangeNoise& noise,
                                          int tile_side);

}  // namespace hybrid::stages
