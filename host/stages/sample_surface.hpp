#pragma once
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// The patch of surface one range sample stands for, scan frame.
struct SampleSurface {
  Vec3 normal = Vec3::Zero();  // unit, towards the scanner; zero when the neighbours do not tell
  double radius_m = 0;         // half the patch's diagonal: spheres of this radius close up
};

// Of a non-empty node. The normal is its supercluster's, else that of the neighbours around it; the
// patch is r x angular step / cos incidence, the quotient at most 3. `segmentation` may be empty.
SampleSurface sample_surface(const RangeImage& image, const PlaneSegmentation& segmentation, int row,
                             int col);

}  // namespace hybrid::stages
