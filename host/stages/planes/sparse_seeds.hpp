#pragma once
#include <vector>

#include "stages/planes/plane_floods.hpp"

namespace hybrid::stages {

// Seeds of planes that return only some of their rays: window glass sends back a third, the rest goes through
// or is lost, and no window of neighbours is mostly on the plane. In windows of 8 x 8 samples, every four
// samples, test planes through three free samples are drawn; the one with the most samples on it, within
// three sigmas along the ray, wins when it holds at least 12 samples and two fifths of the free ones.
// By the upper left corner, row by row; the draws depend on the window's place alone.
std::vector<WindowSeed> find_sparse_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                          const RangeNoise& noise);

// The samples of a seed's window on its winning plane that are free (still), sorted.
std::vector<std::uint32_t> sparse_seed_samples(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                               const WindowSeed& seed);

}  // namespace hybrid::stages
