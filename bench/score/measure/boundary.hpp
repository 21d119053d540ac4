#pragma once
#include "score/measure/joined_scan.hpp"

namespace score {

// How far the borders of a result's regions lie from the true planes' borders, in samples of the grid.
//
// A border is where two neighbours of one row or column (the seam included) differ in being on a plane;
// samples that say nothing (none measured, mixed, ghosts) between two neighbours are stepped over, at most
// kMostSkipped of them. It is a point half-way between the two. Regions count as the true plane most of their
// planar samples lie on. Per true plane that counts and has a region: the distance from each of its true
// borders to the nearest border the result gives it (displaced), and the other way round (invented: holes and
// frayed edges). Planes without a region are not compared; they are missed, which is another measure.
struct BoundaryScore {
  struct Distances {
    std::int64_t borders = 0;
    double median = 0, percentile_95 = 0;  // samples
    double share_beyond_1 = 0;             // of the borders, farther than one sample
  };
  Distances displaced, invented;
  std::int64_t not_compared = 0;  // true borders of planes without a region
};
BoundaryScore score_boundaries(const JoinedScan& scan);

inline constexpr int kMostSkipped = 2;

}  // namespace score
