#pragma once
#include "geometry/superclusters.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::stages {

// Forgets the planes that are patches of the segmentation's cylinders (straight above a scanner a vault
// hardly bends): at most 15 % of their samples, nine tenths of them on the cylinder, or part of a rib:
// a ring about a vault's axis goes on beside them at their radius. Their samples are on no plane then, their
// squares planar but too small; ids close up, most samples first.
void forget_planes_on_cylinders(const RangeImage& image, const RangeNoise& noise,
                                const SuperclusterOptions& options, PlaneSegmentation& segmentation);

}  // namespace hybrid::stages
