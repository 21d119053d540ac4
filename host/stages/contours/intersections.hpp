#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

struct IntersectionOptions {
  double least_angle_deg = 10;  // planes that meet at less have no sharp line
  int reach = 3;                // nodes between the samples of the two planes: mixed ones lie on the edge
  int least_samples = 5;        // of each plane along a segment
  double most_gap = 6;          // spacings without samples inside a segment
};

// A piece of the line in which two planes meet, where samples of both lie along it: the linear features of
// the paper's reference 12. Scan frame, metres.
struct Intersection {
  std::uint32_t planes[2] = {};  // ids, the smaller first
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double angle_deg = 0;  // between the planes as seen by the scanner: over 180 at an edge that stands out
  std::int64_t samples = 0;
};

// The segments in which the superclusters meet, ordered by planes and position. Two samples of two planes up
// to `reach` nodes apart are evidence for their line where both lie within the spacing of the samples there,
// so that an edge before a farther plane is none. Any thread count gives the same segments.
std::vector<Intersection> find_intersections(const RangeImage& image, const PlaneSegmentation& segmentation,
                                             const IntersectionOptions& options = {});

}  // namespace hybrid::stages
