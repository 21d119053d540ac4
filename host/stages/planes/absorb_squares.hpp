#pragma once
#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Squares whose samples lie on a neighbouring region's plane join it, whatever plane of their own they found:
// beside edges, and near the zenith, where a square is a sliver thinner than the range noise, a square's own
// plane says little and growth by normals stops. By METHOD 2's definition such a square is locally planar: at
// least `kLeastShare` of its samples are inliers, and their scatter is what the noise explains. The largest
// region takes first, from none and from regions much smaller than itself.
void absorb_squares(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                    const SuperclusterOptions& options, PlaneRegions& regions);

}  // namespace hybrid::stages
