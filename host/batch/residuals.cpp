#include "batch/residuals.hpp"

#include <algorithm>
#include <cmath>

#include "batch/picture_marks.hpp"

namespace hybrid::batch {
namespace {

constexpr double kScale_m = 0.03, kNear_m = 0.1;
constexpr Ink kBehind = {33, 90, 170}, kOn = {247, 247, 247}, kFront = {180, 20, 40};
constexpr Ink kFar = {110, 110, 110}, kNone = {0, 0, 0}, kPaper = {255, 255, 255}, kText = {30, 30, 30};

Ink ink_of(double distance_m) {
  const double t = std::clamp(distance_m / kScale_m, -1.0, 1.0);
  const Ink& end = t < 0 ? kBehind : kFront;
  Ink ink{};
  for (std::size_t k = 0; k < 3; ++k)
    ink[k] = static_cast<std::uint8_t>(std::lround(kOn[k] + std::abs(t) * (end[k] - kOn[k])));
  return ink;
}

double median_of(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void fill(Image8& picture, int x0, int y0, int x1, int y1, const Ink& ink) {
  for (int y = std::max(y0, 0); y < std::min(y1, picture.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, picture.width); ++x)
      std::copy(ink.begin(), ink.end(), picture.at(x, y));
}

// Scale and histogram, their left edge at `left`, the bins' tops from `top` on.
constexpr int kBinWidth = 14, kBars = 110, kScaleHeight = 14, kCell = 2, kLegend = 200;

void draw_legend(Image8& picture, int left, int top, const ResidualHistogram& histogram) {
  const auto bins = static_cast<int>(histogram.counts.size());
  const double most = static_cast<double>(
      std::max<std::int64_t>(1, *std::max_element(histogram.counts.begin(), histogram.counts.end())));
  const auto centre = [](int b) {
    return -ResidualHistogram::kReach_m + (b + 0.5) * ResidualHistogram::kBin_m;
  };
  const int base = top + kBars;
  for (int b = 0; b < bins; ++b) {
    const int x = left + b * kBinWidth;
    const double share = static_cast<double>(histogram.counts[static_cast<std::size_t>(b)]) / most;
    fill(picture, x, base - static_cast<int>(std::lround(share * kBars)), x + kBinWidth - 2, base,
         {90, 90, 90});
    fill(picture, x, base + 2, x + kBinWidth, base + 2 + kScaleHeight, ink_of(centre(b)));
  }
  const int below = base + kScaleHeight + 8;
  for (int mm = -50; mm <= 50; mm += 10) {
    const int x = left + static_cast<int>(std::lround((mm / 1000.0 + ResidualHistogram::kReach_m) /
                                                      ResidualHistogram::kBin_m * kBinWidth));
    draw_line(picture, Vec2(x, base), Vec2(x, below - 3), kText);
    const std::string text = std::to_string(mm);
    draw_text(picture, x - text_width(text, kCell) / 2, below, text, kCell, kText);
  }
  draw_text(picture, left, below + 22, "mm behind the face", kCell, kText);
  const std::string front = "mm in front of the face";
  draw_text(picture, left + bins * kBinWidth - text_width(front, kCell), below + 22, front, kCell, kText);
}

}  // namespace

ResidualHistogram residual_histogram(const ScanProduct& product, const std::vector<float>& distance_m) {
  using H = ResidualHistogram;
  H histogram;
  histogram.counts.assign(static_cast<std::size_t>(std::lround(2 * H::kReach_m / H::kBin_m)), 0);
  std::vector<float> near;
  for (std::size_t i = 0; i < product.image.count(); ++i) {
    if (product.image.mask[i] != kMeasured || product.segmentation.sample_label[i] == 0) continue;
    const double d = distance_m[i];
    const double bin = std::floor((d + H::kReach_m) / H::kBin_m);
    if (std::isnan(d))
      ++histogram.without_face;
    else if (bin < 0)
      ++histogram.behind;
    else if (bin >= static_cast<double>(histogram.counts.size()))
      ++histogram.before;
    else {
      ++histogram.counts[static_cast<std::size_t>(bin)];
      near.push_back(distance_m[i]);
    }
  }
  histogram.median_m = median_of(near);
  for (float& d : near) d = std::abs(d - static_cast<float>(histogram.median_m));
  histogram.sigma_m = 1.4826 * median_of(near);
  return histogram;
}

nlohmann::ordered_json histogram_json(const ResidualHistogram& histogram) {
  return {{"median_m", histogram.median_m},
          {"sigma_m", histogram.sigma_m},
          {"first_m", -ResidualHistogram::kReach_m},
          {"bin_m", ResidualHistogram::kBin_m},
          {"samples", histogram.counts},
          {"farther_behind", histogram.behind},
          {"farther_in_front", histogram.before},
          {"without_face", histogram.without_face}};
}

Image8 residual_picture(const ScanProduct& product, const std::vector<float>& distance_m,
                        const ResidualHistogram& histogram) {
  constexpr int kWidth = 1600, kMargin = 20;
  const RangeImage& image = product.image;
  const int thin = std::max(1, image.cols / kWidth), enlarge = std::max(1, kWidth / std::max(image.cols, 1));
  const int cols = (image.cols + thin - 1) / thin, rows = (image.rows + thin - 1) / thin;
  const int legend = static_cast<int>(histogram.counts.size()) * kBinWidth;
  const int width = std::max(cols * enlarge, legend + 2 * kMargin);
  Image8 picture(width, rows * enlarge + kLegend, 3);
  fill(picture, 0, 0, picture.width, picture.height, kPaper);
  const int left = (width - cols * enlarge) / 2;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = image.index(row * thin, col * thin);
      const double d = distance_m[i];
      const Ink ink = image.mask[i] != kMeasured ? kNone : std::abs(d) <= kNear_m ? ink_of(d) : kFar;
      fill(picture, left + col * enlarge, row * enlarge, left + (col + 1) * enlarge, (row + 1) * enlarge,
           ink);
    }
  draw_legend(picture, (width - legend) / 2, rows * enlarge + kMargin, histogram);
  return picture;
}

}  // namespace hybrid::batch
