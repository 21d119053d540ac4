#pragma once
#include "stages/plane_regions.hpp"

namespace hybrid::stages {

// Marks (and never unmarks) the regions that are facets of curved surfaces (columns, vaults): chains of links
// and the tolerance for waviness let a strip of a cylinder pass as a plane. A region is curved when
// - a quadratic height field over its plane fits significantly better and bends more than min_curvature, or
// - more than max_crease_share of its rim is in continuous contact with planar squares that, on the mean,
// bend
//   away from it (or towards it) by 2.5 to 30 degrees: the next facets. Only narrow regions are asked.
//   Contact with a region many times larger does not count: that is a wall with a shallow kink; nor do
//   squares that straddle a small step or a corner.
void mark_curved_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                         const SuperclusterOptions& options, PlaneRegions& regions);

// A quadratic height field over (a, b, height) fits significantly better than a plane and bends more than
// min_curvature, 1/m. False when the samples are too few or in too few lines to tell (can_bend).
bool can_bend(const std::vector<Vec3>& heights);
bool bends(const std::vector<Vec3>& heights, double min_curvature);

}  // namespace hybrid::stages
