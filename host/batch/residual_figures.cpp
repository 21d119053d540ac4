#include "batch/residual_figures.hpp"

#include "io/picture.hpp"
#include "stages/residual_picture.hpp"

namespace hybrid::batch {

nlohmann::ordered_json residual_figures(const ScanProduct& product, const ScanRegistration& registration) {
  using Histogram = stages::ResidualHistogram;
  const auto histogram =
      stages::residual_histogram(product.image, product.segmentation, registration.distance_m);
  return {{"median_m", histogram.median_m},         {"p95_m", histogram.p95_m},
          {"without_face", histogram.without_face}, {"from_m", Histogram::kFrom_m},
          {"per_decade", Histogram::kPerDecade},    {"counts", histogram.counts}};
}

void write_residual_picture(const std::filesystem::path& folder, const ScanProduct& product,
                            const ScanRegistration& registration) {
  const auto picture =
      stages::residual_picture(product.image, product.segmentation, registration.distance_m, 2048);
  if (picture.width > 0) io::write_png(folder / "residual.png", picture);
}

}  // namespace hybrid::batch
