#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "batch/scan_unit.hpp"
#include "geometry/image.hpp"

namespace hybrid::batch {

// Nodes of a registered scan and their signed distances to the closest compatible face of the model, or
// surface of another scan: above 0 in front of it, NaN where there is none.
struct ResidualNodes {
  const RangeImage& image;
  const PlaneSegmentation& segmentation;
  const std::vector<float>& signed_m;
};

// How the planar samples among them lie: counts of their distances.
struct ResidualHistogram {
  static constexpr double kBin_m = 0.002, kReach_m = 0.05;
  std::vector<std::int64_t> counts;     // bins from -kReach_m to kReach_m
  std::int64_t behind = 0, before = 0;  // beyond, up to any distance
  std::int64_t without_face = 0;
  double median_m = 0, sigma_m = 0;  // of those within kReach_m; sigma = 1.4826 median deviation
};
ResidualHistogram residual_histogram(const ResidualNodes& nodes);
nlohmann::ordered_json histogram_json(const ResidualHistogram& histogram);

// The scan's grid (thinned or enlarged to about 1600 columns), every measured sample by its distance: blue 30
// mm and more behind a face, white on it, red in front; grey farther than 10 cm from any, black no return.
// Below it the scale, with the histogram over it; `of`: what it is behind and in front of.
Image8 residual_picture(const ResidualNodes& nodes, const ResidualHistogram& histogram,
                        const std::string& of);

}  // namespace hybrid::batch
