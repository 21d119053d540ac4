#include "score/measure/picture_quality.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace score {
namespace {

constexpr int kReach = 5;  // pixels on either side of a window's middle
using Channel = std::vector<double>;

double light_of(double encoded) {
  const double s = encoded / 255;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

double encoded_of(double light) {
  const double c = std::clamp(light, 0.0, 1.0);
  return 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

// Sum of value(i) over the mask: per row on all threads, rows added in order.
template <typename Value>
double sum(const Picture& size, const std::vector<std::uint8_t>& mask, const Value& value) {
  const auto width = static_cast<std::size_t>(size.width);
  Channel rows(static_cast<std::size_t>(size.height), 0.0);
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i)
      if (mask[i]) rows[row] += value(i);
  });
  double total = 0;
  for (const double row : rows) total += row;
  return total;
}

// Gaussian windows over the masked pixels, rows first and columns after; the weight of what is masked out is
// 0.
class Windows {
 public:
  Windows(const Picture& size, const std::vector<std::uint8_t>& mask, double sigma)
      : size_(size), mask_(mask) {
    for (int k = 0; k <= kReach; ++k) taper_[k] = std::exp(-0.5 * k * k / (sigma * sigma));
    Channel ones(mask.begin(), mask.end());
    weight_ = both_ways(ones);
  }

  // The windows' means of value(i).
  template <typename Value>
  Channel means(const Value& value) const {
    Channel masked(mask_.size());
    for (std::size_t i = 0; i < masked.size(); ++i) masked[i] = mask_[i] ? value(i) : 0;
    Channel out = both_ways(masked);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = weight_[i] > 0 ? out[i] / weight_[i] : 0;
    return out;
  }

 private:
  Channel both_ways(const Channel& in) const {
    return pass(pass(in, 1, size_.width), size_.width, size_.height);
  }

  // `stride` between the neighbours along a line of `length` pixels.
  Channel pass(const Channel& in, int stride, int length) const {
    Channel out(in.size());
    tbb::parallel_for(0, size_.height, [&](int row) {
      for (int col = 0; col < size_.width; ++col) {
        const int place = stride == 1 ? col : row;
        const auto here = static_cast<std::ptrdiff_t>(row) * size_.width + col;
        double total = 0;
        for (int k = std::max(-kReach, -place); k <= std::min(kReach, length - 1 - place); ++k)
          total += taper_[std::abs(k)] *
                   in[static_cast<std::size_t>(here + static_cast<std::ptrdiff_t>(k) * stride)];
        out[static_cast<std::size_t>(here)] = total;
      }
    });
    return out;
  }

  const Picture& size_;
  const std::vector<std::uint8_t>& mask_;
  double taper_[kReach + 1];
  Channel weight_;
};

Channel luma(const std::vector<double>& rgb) {
  Channel y(rgb.size() / 3);
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 0.299 * rgb[3 * i] + 0.587 * rgb[3 * i + 1] + 0.114 * rgb[3 * i + 2];
  return y;
}

double structural_similarity(const Windows& windows, const Picture& size,
                             const std::vector<std::uint8_t>& mask, const Channel& a, const Channel& b,
                             double compared) {
  const Channel mean_a = windows.means([&](std::size_t i) { return a[i]; });
  const Channel mean_b = windows.means([&](std::size_t i) { return b[i]; });
  const Channel aa = windows.means([&](std::size_t i) { return a[i] * a[i]; });
  const Channel bb = windows.means([&](std::size_t i) { return b[i] * b[i]; });
  const Channel ab = windows.means([&](std::size_t i) { return a[i] * b[i]; });
  const double c1 = std::pow(0.01 * 255, 2), c2 = std::pow(0.03 * 255, 2);
  return sum(size, mask,
             [&](std::size_t i) {
               const double ma = mean_a[i], mb = mean_b[i], covariance = ab[i] - ma * mb;
               const double variances = std::max(aa[i] - ma * ma, 0.0) + std::max(bb[i] - mb * mb, 0.0);
               return (2 * ma * mb + c1) * (2 * covariance + c2) /
                      ((ma * ma + mb * mb + c1) * (variances + c2));
             }) /
         compared;
}

}  // namespace

PictureQuality compare_pictures(const Picture& linear, const Picture& srgb_truth,
                                const std::vector<std::uint8_t>& wanted) {
  PictureQuality quality;
  std::vector<std::uint8_t> mask = wanted;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (!std::isfinite(linear.rgb[3 * i] + linear.rgb[3 * i + 1] + linear.rgb[3 * i + 2])) mask[i] = 0;
  quality.compared = std::count_if(mask.begin(), mask.end(), [](auto used) { return used != 0; });
  if (quality.compared == 0) return quality;
  const auto compared = static_cast<double>(quality.compared);

  std::vector<double> ours(linear.rgb.size()), truth(srgb_truth.rgb.begin(), srgb_truth.rgb.end());
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = [&](std::size_t i) { return static_cast<double>(linear.rgb[3 * i + k]); };
    const double ours_squared = sum(linear, mask, [&](std::size_t i) { return value(i) * value(i); });
    const double product =
        sum(linear, mask, [&](std::size_t i) { return value(i) * light_of(truth[3 * i + k]); });
    if (ours_squared > 0) quality.gain[k] = product / ours_squared;
    for (std::size_t i = 0; i < mask.size(); ++i)
      ours[3 * i + k] = mask[i] ? encoded_of(quality.gain[k] * value(i)) : 0;
    squared +=
        sum(linear, mask, [&](std::size_t i) { return std::pow(ours[3 * i + k] - truth[3 * i + k], 2); });
  }
  const double mean = squared / (3 * compared);
  quality.psnr_db = mean > 0 ? std::min(kBestPsnrDb, 10 * std::log10(255 * 255 / mean)) : kBestPsnrDb;

  const Channel a = luma(ours), b = luma(truth);
  const Windows windows(linear, mask, 1.5);
  quality.ssim = structural_similarity(windows, linear, mask, a, b, compared);

  const Windows blur(linear, mask, kSharpnessSigmaPx);
  const Channel low_a = blur.means([&](std::size_t i) { return a[i]; });
  const Channel low_b = blur.means([&](std::size_t i) { return b[i]; });
  const auto high_a = [&](std::size_t i) { return a[i] - low_a[i]; };
  const auto high_b = [&](std::size_t i) { return b[i] - low_b[i]; };
  const double energy_a = sum(linear, mask, [&](std::size_t i) { return high_a(i) * high_a(i); });
  const double energy_b = sum(linear, mask, [&](std::size_t i) { return high_b(i) * high_b(i); });
  const double common = sum(linear, mask, [&](std::size_t i) { return high_a(i) * high_b(i); });
  // A truth without detail asks for none.
  quality.sharpness = energy_b > 0 ? std::sqrt(energy_a / energy_b) : energy_a > 0 ? 0 : 1;
  quality.detail_agreement = energy_a > 0 && energy_b > 0 ? common / std::sqrt(energy_a * energy_b)
                                                          : (energy_a > 0) == (energy_b > 0);
  return quality;
}

}  // namespace score
