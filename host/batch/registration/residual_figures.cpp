#include "batch/registration/residual_figures.hpp"

#include "stages/registration/residual_histogram.hpp"

namespace hybrid::batch {

nlohmann::ordered_json residual_figures(const RegisteredNodes& found) {
  using Histogram = stages::ResidualHistogram;
  const auto& [image, segmentation, signed_m] = found.nodes;
  const auto histogram = stages::residual_histogram(image, segmentation, signed_m);
  return {{"to", found.to},
          {"median_m", histogram.median_m},
          {"p95_m", histogram.p95_m},
          {"without_face", histogram.without_face},
          {"from_m", Histogram::kFrom_m},
          {"per_decade", Histogram::kPerDecade},
          {"counts", histogram.counts}};
}

}  // namespace hybrid::batch
