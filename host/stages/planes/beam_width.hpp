#pragma once
#include "stages/planes/rim_crossings.hpp"

namespace hybrid::stages {

// Across how much a scanner's beam mixes what it meets on both sides of an edge.
struct BeamWidth {
  double base_m = 0, per_m = 0;  // both 0: not to be seen in this scan
  double at(double range_m) const { return base_m + per_m * range_m; }
};

// Measured in the scan itself: at jumps in depth between planes so large that the mixed samples in between
// are neither's, it is as wide as the nodes without a label, whatever the spacing; a straight line over the
// range fitted to half octaves of it. `labels` are those that `crossings` looks at.
BeamWidth measure_beam(const RangeImage& image, const RimCrossings& crossings,
                       const std::vector<std::uint32_t>& labels);

}  // namespace hybrid::stages
