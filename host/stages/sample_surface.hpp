#pragma once
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// The patch of surface one range sample stands for, scan frame.
struct SampleSurface {
  Vec3 normal = Vec3::Zero();  // unit, towards the scanner; zero when the neighbours do not tell
  double radius_m = 0;         // half the patch's diagonal: spheres of this radius close up
};

// Of a non-empty node. With a supercluster: its normal, and a patch of r x angular step by r x angular step /
// cos incidence. Without: the normal of the neighbours around it, and a patch as long as the distances to the
// neighbours on the same surface. No side is longer than 4 r x angular step. `segmentation` may be empty.
SampleSurface sample_surface(const RangeImage& image, const PlaneSegmentation& segmentation, int row,
                             int col);

}  // namespace hybrid::stages
