#pragma once
#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Joins regions that are one plane broken by an occluder: their planes agree at each other's centroids within
// waviness and covariance (at most 2 cm and 5 degrees), and between their nearest squares the scan never
// looks through the plane: samples there lie on it, in front of it or are missing. The larger region, of at
// least min_squares, takes the smaller one; curved regions stay out.
void merge_coplanar_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                            const SuperclusterOptions& options, PlaneRegions& regions);

// The largest region that, by the same tests, `small` continues: index + 1, 0 = none.
std::uint32_t coplanar_region(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                              const SuperclusterOptions& options, const PlaneRegions& regions,
                              const PlaneRegion& small);

}  // namespace hybrid::stages
