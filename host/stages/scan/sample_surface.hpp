#pragma once
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// The patch of surface one range sample stands for, scan frame.
struct SampleSurface {
  Vec3 normal = Vec3::Zero();  // unit, towards the scanner; zero when the neighbours do not tell
  double radius_m = 0;         // half the patch's diagonal: spheres of this radius close up
};

// A node whose patch has no larger radius than this, whatever its neighbours say.
struct RadiusLimit {
  std::uint32_t node = 0;
  float radius_m = 0;
};

// Of the samples of a range image, which is kept by reference, as the segmentation is; that may be empty.
class SampleSurfaces {
 public:
  SampleSurfaces(const RangeImage& image, const PlaneSegmentation& segmentation);

  // Of a non-empty node. With a supercluster: its normal, and a patch of r x angular step by r x angular step
  // / cos incidence. Without: the normal of the neighbours around it, and a patch as long as the distances to
  // the neighbours on the same surface, up to an edge. No side is longer than 4 r x angular step.
  SampleSurface at(int row, int col) const;

 private:
  int column(int col) const;  // across the seam; -1: there is none
  Vec3 neighbour_normal(int row, int col, double spacing_m) const;
  double neighbour_spacing(int row, int col, int down, int across, double nominal_m,
                           const Vec3& normal) const;

  const RangeImage& image_;
  const PlaneSegmentation& segmentation_;
  double down_rad_, across_rad_;  // angular steps
};

}  // namespace hybrid::stages
