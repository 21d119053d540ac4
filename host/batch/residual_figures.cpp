#include "batch/residual_figures.hpp"

#include "stages/residual_histogram.hpp"

namespace hybrid::batch {

nlohmann::ordered_json residual_figures(const ScanProduct& product, const ScanRegistration& registration) {
  using Histogram = stages::ResidualHistogram;
  const auto histogram =
      stages::residual_histogram(product.image, product.segmentation, registration.signed_distance_m);
  return {{"median_m", histogram.median_m},         {"p95_m", histogram.p95_m},
          {"without_face", histogram.without_face}, {"from_m", Histogram::kFrom_m},
          {"per_decade", Histogram::kPerDecade},    {"counts", histogram.counts}};
}

}  // namespace hybrid::batch
