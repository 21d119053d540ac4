#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// How far the planar samples of a registered scan lie from the model, in steps that grow by a factor: what
// differs by 1 mm and by 10 cm is seen in one figure.
struct ResidualHistogram {
  static constexpr double kFrom_m = 1e-4;  // the first bin holds all that is less
  static constexpr int kPerDecade = 5;
  static constexpr int kBins = 22;  // below 0.1 mm; 20 up to 1 m; above
  std::array<std::int64_t, kBins> counts{};
  std::int64_t without_face = 0;   // no face of a similar direction is near
  double median_m = 0, p95_m = 0;  // of the counted; 0 when there is none
};

// `distance_m`: per node, of either sign, NaN = no compatible face (signed_distance_to_model()). Of large
// scans every n-th row and column, so that at most about a million nodes are counted.
ResidualHistogram residual_histogram(const RangeImage& image, const PlaneSegmentation& segmentation,
                                     const std::vector<float>& distance_m);

}  // namespace hybrid::stages
