#pragma once
#include <utility>
#include <vector>

#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Squares in which a small plane holds samples: (square, region + 1), sorted.
using SquarePresence = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// Planes too small or too narrow for whole squares (jambs, sills, shelves, table legs), from the measured
// samples that no region took (label 0): small windows that lie on a plane seed floods along it, the largest
// flood first. A flood becomes a region (`small`, without squares) with its plane appended to `planes` when
// it has enough samples, their scatter is what the noise explains, it does not bend and does not lie beside
// curved regions; one that continues the plane of a region is given to that region. `labels` (region + 1 per
// sample) stay as they are: the presence says where the planes compete for samples next. Kernel:
// window_planes.
SquarePresence recover_small_planes(device::Queue& queue, const RangeImage& image,
                                    const SquarePlanes& squares, const SquareGrid& grid,
                                    const std::vector<std::uint32_t>& labels,
                                    const SuperclusterOptions& options, PlaneRegions& regions,
                                    std::vector<Plane>& planes);

// Least samples of a small plane: options.min_plane_samples, and one in 200,000 of the image's.
std::int64_t least_plane_samples(const RangeImage& image, const SuperclusterOptions& options);

}  // namespace hybrid::stages
