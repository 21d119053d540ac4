#pragma once
#include "stages/scan/sweeps.hpp"

namespace hybrid::stages {

// Columns for a cloud that was not scanned in columns, or has lost them (thinned, merged, in any order).
struct ScatteredSweeps {
  Sweeps sweeps;        // bins of azimuth, `step_rad` wide, those without samples left out
  double step_rad = 0;  // 0: too few samples to tell
};

// The angular step found from the data (METHOD 1): the side of a square of solid angle with one sample in it,
// on the median over the samples. Depends on the set of directions alone, not on the samples' order.
ScatteredSweeps scatter_sweeps(const SampleAngles& angles);

}  // namespace hybrid::stages
