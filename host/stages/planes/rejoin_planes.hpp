#pragma once
#include <cstdint>
#include <vector>

#include "stages/planes/sample_labels.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// Joins planes that turn out to be one now that samples have fixed them: what an occluder broke, where the
// fit to the first few samples of a part was too poor to tell (merge_coplanar_regions and coplanar_region
// went by that). A part belongs to a plane with more samples when they lie about it as closely as about its
// own, within noise and what the plane is uncertain by there, and the scan does not look through the plane
// between the two, or they take turns on one surface. Half of the samples decide, so that those on the part's
// edges, which belong to what stands beside it and had tilted it, do not. Likewise planes that cross another
// one within its noise. Labels, regions and presence of the part become the plane's; it keeps its equation.
// Returns the labels of the planes that grew.
std::vector<std::uint32_t> rejoin_planes(const RangeImage& image, const SquarePlanes& squares,
                                         const SquareGrid& grid, const SuperclusterOptions& options,
                                         const std::vector<Plane>& planes, std::vector<std::uint32_t>& labels,
                                         PlaneRegions& regions, SquarePresence& presence);

}  // namespace hybrid::stages
