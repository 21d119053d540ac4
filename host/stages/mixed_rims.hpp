#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"
#include "stages/noise_model.hpp"
#include "stages/plane_regions.hpp"

namespace hybrid::stages {

// Takes from planes the samples at their rims whose beams met another surface as well, before or behind the
// plane: each is within its noise, all of a rim lie to that surface's side. Looks, where samples are dense
// enough, at those from which a jump in depth is a few nodes away; where the mean of a rim's samples around
// one of them is off the plane, it loses its label unless it lies to the other side. The rows that become
// the rim are looked at once more. How many samples each label lost.
std::vector<std::int64_t> trim_mixed_rims(const RangeImage& image, const RangeNoise& noise,
                                          const std::vector<Plane>& planes, const PlaneRegions& regions,
                                          std::vector<std::uint32_t>& labels);

}  // namespace hybrid::stages
