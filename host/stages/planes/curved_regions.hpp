#pragma once
#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Marks (and never unmarks) the regions that are facets of curved surfaces (columns, vaults): chains of links
// and the tolerance for waviness let a strip of a cylinder pass as a plane. A region is curved when
// - a quadratic height field over its plane fits significantly better and bends more than min_curvature (a
//   strip that bends by less than a tenth of its noise, or a patch whose bend noise hides: when the squares
//   around it go on without an edge and bend as much, or so that their bend explains it better), or
// - more than max_crease_share of its rim is in continuous contact with planar squares that, on the
//   mean, bend away from it (or towards it) by 2.5 to 30 degrees: the next facets. Only narrow regions are
//   asked. Contact with a region many times larger does not count: that is a wall with a shallow kink; nor do
//   squares that straddle a small step or a corner; and a region whose own samples bend by less than a
//   quarter of that turn is flat.
// `fragments`: regions of less than 16 squares are judged by what is around them, too. Not before regions
// merge: those that are left would have fewer to merge with.
void mark_curved_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                         const SuperclusterOptions& options, bool fragments, PlaneRegions& regions);

}  // namespace hybrid::stages
