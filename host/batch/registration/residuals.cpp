#include "batch/registration/residuals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "batch/picture_marks.hpp"
#include "core/median.hpp"

namespace hybrid::batch {
namespace {

constexpr double kScale_m = 0.03, kNearModel_m = 0.1;
constexpr Ink kBehind = {33, 90, 170}, kOn = {247, 247, 247}, kFront = {180, 20, 40};
constexpr Ink kFar = {110, 110, 110}, kNone = {0, 0, 0}, kText = {30, 30, 30};

Ink ink_of(double distance_m) {
  const double t = std::clamp(distance_m / kScale_m, -1.0, 1.0);
  const Ink& end = t < 0 ? kBehind : kFront;
  Ink ink{};
  for (std::size_t k = 0; k < 3; ++k)
    ink[k] = static_cast<std::uint8_t>(std::lround(kOn[k] + std::abs(t) * (end[k] - kOn[k])));
  return ink;
}

constexpr auto kBins =
    static_cast<std::size_t>(2 * ResidualHistogram::kReach_m / ResidualHistogram::kBin_m + 0.5);

struct Counts {
  std::array<std::int64_t, kBins> bins{};
  std::int64_t behind = 0, before = 0, without_face = 0;

  Counts& operator+=(const Counts& other) {
    for (std::size_t b = 0; b < kBins; ++b) bins[b] += other.bins[b];
    behind += other.behind;
    before += other.before;
    without_face += other.without_face;
    return *this;
  }
};

// In bins; below 0 or from kBins on: beyond the histogram.
double place_of(double distance_m) {
  return (distance_m + ResidualHistogram::kReach_m) / ResidualHistogram::kBin_m;
}

void fill(Image8& picture, int x0, int y0, int x1, int y1, const Ink& ink) {
  for (int y = std::max(y0, 0); y < std::min(y1, picture.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, picture.width); ++x)
      std::copy(ink.begin(), ink.end(), picture.at(x, y));
}

// Scale and histogram, their left edge at `left`, the bins' tops from `top` on.
constexpr int kBinWidth = 14, kBars = 110, kScaleHeight = 14, kLegendCell = 2, kLegend = 200;

void draw_legend(Image8& picture, int left, int top, const ResidualHistogram& histogram,
                 const std::string& of) {
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
    draw_text(picture, x - text_width(text, kLegendCell) / 2, below, text, kLegendCell, kText);
  }
  draw_text(picture, left, below + 22, "mm behind " + of, kLegendCell, kText);
  const std::string front = "mm in front of " + of;
  draw_text(picture, left + bins * kBinWidth - text_width(front, kLegendCell), below + 22, front, kLegendCell,
            kText);
}

}  // namespace

ResidualHistogram residual_histogram(const ResidualNodes& nodes) {
  const auto& distance_m = nodes.signed_m;
  const auto counted = [&](std::size_t i) {
    return nodes.image.mask[i] == kMeasured && nodes.segmentation.sample_label[i] != 0;
  };
  const Counts counts = sum_blocks<Counts>(nodes.image.count(), [&](std::size_t begin, std::size_t end) {
    Counts own;
    for (std::size_t i = begin; i < end; ++i) {
      if (!counted(i)) continue;
      const double place = place_of(distance_m[i]);
      if (std::isnan(place))
        ++own.without_face;
      else if (place < 0)
        ++own.behind;
      else if (place >= static_cast<double>(kBins))
        ++own.before;
      else
        ++own.bins[static_cast<std::size_t>(place)];
    }
    return own;
  });
  ResidualHistogram histogram;
  histogram.counts.assign(counts.bins.begin(), counts.bins.end());
  histogram.behind = counts.behind;
  histogram.before = counts.before;
  histogram.without_face = counts.without_face;
  const auto near = [&](std::size_t i) {
    const double place = counted(i) ? place_of(distance_m[i]) : -1;
    return place >= 0 && place < static_cast<double>(kBins) ? distance_m[i]
                                                            : std::numeric_limits<float>::quiet_NaN();
  };
  const float median_m = parallel_median(distance_m.size(), near);
  histogram.median_m = median_m;
  histogram.sigma_m = 1.4826 * parallel_median(distance_m.size(),
                                               [&](std::size_t i) { return std::abs(near(i) - median_m); });
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

Image8 residual_picture(const ResidualNodes& nodes, const ResidualHistogram& histogram,
                        const std::string& of) {
  constexpr int kWidth = 1600, kMargin = 20;
  const RangeImage& image = nodes.image;
  const int thin = std::max(1, image.cols / kWidth), enlarge = std::max(1, kWidth / std::max(image.cols, 1));
  const int cols = (image.cols + thin - 1) / thin, rows = (image.rows + thin - 1) / thin;
  const int legend = static_cast<int>(histogram.counts.size()) * kBinWidth;
  const int width = std::max(cols * enlarge, legend + 2 * kMargin);
  Image8 picture(width, rows * enlarge + kLegend, 3);
  fill(picture, 0, 0, picture.width, picture.height, kPaper);
  const int left = (width - cols * enlarge) / 2;
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = image.index(row * thin, col * thin);
      const double d = nodes.signed_m[i];
      const Ink ink = image.mask[i] != kMeasured ? kNone : std::abs(d) <= kNearModel_m ? ink_of(d) : kFar;
      fill(picture, left + col * enlarge, row * enlarge, left + (col + 1) * enlarge, (row + 1) * enlarge,
           ink);
    }
  });
  draw_legend(picture, (width - legend) / 2, rows * enlarge + kMargin, histogram, of);
  return picture;
}

}  // namespace hybrid::batch
