#include "stages/residual_picture.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr double kPale_m = 0.001, kDark_m = 0.1;
// Lightness falls from the first to the last, so that the order is seen without telling hues apart.
constexpr std::array<Colour, 5> kRamp = {
    {{238, 243, 225}, {250, 214, 110}, {240, 140, 60}, {205, 50, 45}, {95, 5, 30}}};
constexpr Colour kNoFace = {40, 80, 190}, kNotPlanar = {105, 105, 105}, kNoReturn = {0, 0, 0};

Colour ramp(double distance_m) {
  const double t = std::log(std::max(distance_m, kPale_m) / kPale_m) / std::log(kDark_m / kPale_m);
  const double place = std::clamp(t, 0.0, 1.0) * (kRamp.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), kRamp.size() - 2);
  const double share = place - static_cast<double>(low);
  Colour colour;
  for (std::size_t k = 0; k < 3; ++k)
    colour[k] =
        static_cast<std::uint8_t>(std::lround((1 - share) * kRamp[low][k] + share * kRamp[low + 1][k]));
  return colour;
}

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
      counted.push_back(distance_m[i]);
      ++result.counts[static_cast<std::size_t>(bin_of(distance_m[i]))];
    }
  result.median_m = percentile(counted, 50);
  result.p95_m = percentile(counted, 95);
  return result;
}

Image8 residual_picture(const RangeImage& image, const PlaneSegmentation& segmentation,
                        const std::vector<float>& distance_m, int largest_side) {
  check(image, segmentation, distance_m);
  const int step = (std::max(image.rows, image.cols) + largest_side - 1) / largest_side;
  if (image.count() == 0) return {};
  Image8 picture((image.cols + step - 1) / step, (image.rows + step - 1) / step, 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t i = image.index(y * step, x * step);
      Colour colour = kNoReturn;
      if (image.mask[i] == kMeasured && segmentation.sample_label[i] == 0)
        colour = kNotPlanar;
      else if (image.mask[i] == kMeasured)
        colour = std::isnan(distance_m[i]) ? kNoFace : ramp(distance_m[i]);
      std::copy(colour.begin(), colour.end(), picture.at(x, y));
    }
  return picture;
}

}  // namespace hybrid::stages
