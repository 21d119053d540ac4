#pragma once
#include "geometry/range_image.hpp"
#include "stages/planes/sample_labels.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// Takes from planes what belongs to curved surfaces that leave them along a tangent, as a vault leaves its
// wall: the first decimetres are within the noise of the plane, sample by sample. Where the surface goes on
// smoothly from a plane's rim over samples of no plane, the heights over the plane on both sides of the rim
// are fitted by a parabola that begins on a line along it, and by a crease. Where the parabola is clearly
// the better one, samples beyond its line lose their label. Rims are looked at in tiles of 32 x 32
// samples, larger where squares (`square` samples a side) are and wider towards the poles of the grid, those
// of one tile that do not touch each on its own.
// `excess`: factor on the noise of means (split_steps). The labels that lost samples.
std::vector<std::uint32_t> trim_tangent_rims(const RangeImage& image, const RangeNoise& noise, double excess,
                                             std::vector<std::uint32_t>& labels,
                                             const std::vector<Plane>& planes, const PlaneRegions& regions,
                                             int square);

}  // namespace hybrid::stages
