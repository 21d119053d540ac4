#include "stages/planes/thinned_image.hpp"

#include <algorithm>

#include "core/large_vector.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFinestStep_rad = 0.001;
constexpr int kMostThinning = 8;

// Of a scan with smaller steps than kFinestStep_rad windows of a few samples say little, their noise is wider
// than they are: planes are looked for among every so many rows and columns.
int thinning(const RangeImage& image) {
  const double step_rad = image.step_rad();
  return step_rad > 0 ? std::clamp(static_cast<int>(kFinestStep_rad / step_rad), 1, kMostThinning) : 1;
}

}  // namespace

ThinnedImage::ThinnedImage(const RangeImage& whole) : whole_(whole), stride_(thinning(whole)) {
  if (stride_ == 1) return;
  RangeImage& to = thinned_;
  to.rows = (whole.rows + stride_ - 1) / stride_;
  to.cols = (whole.cols + stride_ - 1) / stride_;
  to.wraps = whole.wraps;
  for (int row = 0; row < to.rows; ++row)
    to.elevation_rad.push_back(whole.elevation_rad[static_cast<std::size_t>(row * stride_)]);
  for (int col = 0; col < to.cols; ++col)
    to.azimuth_rad.push_back(whole.azimuth_rad[static_cast<std::size_t>(col * stride_)]);
  for (auto* values : {&to.x, &to.y, &to.z}) resize_large(*values, to.count());
  resize_large(to.mask, to.count());
  parallel_for(
      to.count(),
      [&](std::size_t i) {
        const std::size_t from = whole_index(i);
        to.x[i] = whole.x[from];
        to.y[i] = whole.y[from];
        to.z[i] = whole.z[from];
        to.mask[i] = whole.mask[from];
      },
      1 << 14);
}

std::size_t ThinnedImage::whole_index(std::size_t sample) const {
  if (stride_ == 1) return sample;
  const auto cols = static_cast<std::size_t>(thinned_.cols), every = static_cast<std::size_t>(stride_);
  return sample / cols * every * static_cast<std::size_t>(whole_.cols) + sample % cols * every;
}

}  // namespace hybrid::stages
