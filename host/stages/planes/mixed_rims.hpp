#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"
#include "stages/planes/beam_width.hpp"
#include "stages/planes/plane_regions.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// Within which samples were given to planes: sigmas of range noise, and this along the normal.
struct RimTolerance {
  double sigmas = 0, waviness_m = 0;
};

// Takes from planes the samples at their rims whose beams met another surface as well: where there is a jump
// in depth to it, those that lean to its side, the more so the smaller the jump is; where the two meet in a
// crease, those nearer to it than half a beam (BeamWidth), if the surface beyond soon leaves the plane. The
// samples that become the rim are looked at again, as far in as half a beam reaches 4 m away. Small planes
// that are hardly wider than a beam are dropped. With no width of the beam to go by, that is all. How many
// samples each label lost.
std::vector<std::int64_t> trim_mixed_rims(const RangeImage& image, const RangeNoise& noise,
                                          const BeamWidth& beam, const RimTolerance& tolerance,
                                          const std::vector<Plane>& planes, const PlaneRegions& regions,
                                          std::vector<std::uint32_t>& labels);

}  // namespace hybrid::stages
