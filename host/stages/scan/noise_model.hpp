#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "shared/range_noise.h"
#include "shared/records.h"

namespace hybrid::stages {

inline double incidence_tangent(double cosine) {
  return std::sqrt(std::max(0.0, 1 - cosine * cosine)) / std::max(cosine, 1e-6);
}

// Standard deviation of the noise along a ray as a function of range and incidence (shared/range_noise.h).
struct RangeNoise {
  double base_m = 0;
  double per_m = 0, per_tan_m = 0, per_m_tan = 0;

  double at(double range_m, double cosine) const {
    const double tangent = std::min(incidence_tangent(cosine), double{RANGE_NOISE_MOST_TAN});
    return base_m + per_m * range_m + (per_tan_m + per_m_tan * range_m) * tangent;
  }
  RangeNoiseRecord record() const;
};

// What the planar squares' scatter along the rays says about the noise. Squares are sorted by range (half
// octaves) and tangent of the incidence; a bin's noise is the median of its squares' variances, which squares
// with relief or a bend hardly move. The model is the least squares fit to the bins without negative
// coefficients. Bins with fewer than 12 squares say nothing; with no bin at all the noise is `sigma_m`
// everywhere. At least 0.1 mm.
RangeNoise fit_range_noise(const std::vector<SquareRecord>& squares, double sigma_m);

}  // namespace hybrid::stages
