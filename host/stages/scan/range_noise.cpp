#include "stages/scan/range_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/median.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr int kBlock = 16;
constexpr std::size_t kFewestTriples = 32;  // triples that make a block's median worth something
constexpr double kFloorM = 1e-4;
constexpr double kNormalMedian = 0.67449;  // median of |N(0, 1)|

// |residual| of sample `b` against the line through `a` above and `c` below, in parts of its standard
// deviation for noise of 1 m; NaN when one was not measured.
double residual(const RangeImage& image, std::size_t a, std::size_t b, std::size_t c) {
  if (image.mask[a] != kMeasured || image.mask[b] != kMeasured || image.mask[c] != kMeasured) return NAN;
  const auto elevation = [&](std::size_t i) {
    return std::atan2(double{image.z[i]}, std::hypot(double{image.x[i]}, double{image.y[i]}));
  };
  const double at = elevation(b), up = std::sin(elevation(a) - at), down = std::sin(at - elevation(c));
  const double ra = image.range_m[a], rc = image.range_m[c];
  const double across = ra * up + rc * down;
  if (!(up > 0 && down > 0)) return NAN;
  const double predicted = ra * rc * std::sin(elevation(a) - elevation(c)) / across;
  const double by_a = predicted / ra * (rc * down / across), by_c = predicted / rc * (ra * up / across);
  return std::abs(image.range_m[b] - predicted) / std::sqrt(1 + by_a * by_a + by_c * by_c);
}

double block_noise(const RangeImage& image, int first_row, int first_col) {
  std::vector<double> residuals;
  for (int row = first_row + 1; row + 1 < std::min(first_row + kBlock, image.rows); ++row)
    for (int col = first_col; col < std::min(first_col + kBlock, image.cols); ++col) {
      const double size =
          residual(image, image.index(row - 1, col), image.index(row, col), image.index(row + 1, col));
      if (!std::isnan(size)) residuals.push_back(size);
    }
  return residuals.size() < kFewestTriples ? NAN : median(residuals) / kNormalMedian;
}

}  // namespace

double estimate_range_noise(const RangeImage& image) {
  const int block_rows = (image.rows + kBlock - 1) / kBlock, block_cols = (image.cols + kBlock - 1) / kBlock;
  const double blocks = static_cast<double>(block_rows) * block_cols;
  const int stride = std::max(1, static_cast<int>(std::sqrt(blocks / 4096)));
  std::vector<std::pair<int, int>> chosen;
  for (int row = 0; row < block_rows; row += stride)
    for (int col = 0; col < block_cols; col += stride) chosen.push_back({row * kBlock, col * kBlock});
  std::vector<double> noise(chosen.size());
  parallel_for(chosen.size(),
               [&](std::size_t k) { noise[k] = block_noise(image, chosen[k].first, chosen[k].second); });
  std::erase_if(noise, [](double n) { return std::isnan(n); });
  return noise.empty() ? kFloorM : std::max(kFloorM, median(noise));
}

}  // namespace hybrid::stages
