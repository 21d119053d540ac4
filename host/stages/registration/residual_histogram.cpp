#include "stages/registration/residual_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

int bin_of(double distance_m) {
  if (distance_m < ResidualHistogram::kFrom_m) return 0;
  const double steps = std::log10(distance_m / ResidualHistogram::kFrom_m) * ResidualHistogram::kPerDecade;
  return std::min(1 + static_cast<int>(steps), ResidualHistogram::kBins - 1);
}

double percentile(std::vector<float>& values, std::size_t percent) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void check(const RangeImage& image, const PlaneSegmentation& segmentation,
           const std::vector<float>& distance_m) {
  if (distance_m.size() != image.count() || segmentation.sample_label.size() != image.count())
    fail(ErrorKind::failed, "residuals: {} distances and {} labels for an image of {} samples",
         distance_m.size(), segmentation.sample_label.size(), image.count());
}

}  // namespace

ResidualHistogram residual_histogram(const RangeImage& image, const PlaneSegmentation& segmentation,
                                     const std::vector<float>& distance_m) {
  check(image, segmentation, distance_m);
  ResidualHistogram result;
  std::vector<float> counted;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(image.count()) / 1e6)));
  for (int row = 0; row < image.rows; row += step)
    for (int col = 0; col < image.cols; col += step) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] != kMeasured || segmentation.sample_label[i] == 0) continue;
      if (std::isnan(distance_m[i])) {
        ++result.without_face;
        continue;
      }
      const float distance = std::abs(distance_m[i]);
      counted.push_back(distance);
      ++result.counts[static_cast<std::size_t>(bin_of(distance))];
    }
  result.median_m = percentile(counted, 50);
  result.p95_m = percentile(counted, 95);
  return result;
}

}  // namespace hybrid::stages
