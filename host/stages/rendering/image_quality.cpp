#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBestPsnr_db = 100;  // of identical images, so that reports stay finite
constexpr int kWindow = 5;            // pixels on either side: 11 x 11 (Wang et al. 2004)
constexpr double kWindowSigma_px = 1.5;
constexpr std::array<double, 3> kLuma{0.299, 0.587, 0.114};  // ITU-R BT.601, as SSIM is usually reported

// Both images as sRGB-encoded values 0..255, and which pixels count.
struct Pair {
  int width, height;
  std::array<double, 3> gain;
  std::vector<std::array<float, 3>> ours, theirs;
  std::vector<std::uint8_t> mask;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

// term(x, y, sums) over the masked pixels: row by row on all threads, rows added in order.
template <std::size_t N, typename Term>
std::array<double, N> sum_masked(int width, int height, const std::vector<std::uint8_t>& mask,
                                 const Term& term) {
  std::vector<std::array<double, N>> rows(static_cast<std::size_t>(height), std::array<double, N>{});
  parallel_for(rows.size(), [&](std::size_t y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x)
      if (mask[y * static_cast<std::size_t>(width) + x])
        term(static_cast<int>(x), static_cast<int>(y), rows[y]);
  });
  std::array<double, N> sums{};
  for (const auto& row : rows)
    for (std::size_t k = 0; k < N; ++k) sums[k] += row[k];
  return sums;
}

// Our exposure against the reference's: least squares per channel in linear light.
std::array<double, 3> fit_gains(const ImageF& linear, const Image8& reference,
                                const std::vector<std::uint8_t>& mask) {
  const auto& light_of = linear_of_bytes<double>();
  const auto sums =
      sum_masked<6>(linear.width, linear.height, mask, [&](int x, int y, std::array<double, 6>& sum) {
        for (std::size_t k = 0; k < 3; ++k) {
          const double ours = linear.at(x, y)[k], theirs = light_of[reference.at(x, y)[k]];
          sum[k] += ours * theirs;
          sum[3 + k] += ours * ours;
        }
      });
  std::array<double, 3> gains{1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k)
    if (sums[3 + k] > 0) gains[k] = sums[k] / sums[3 + k];
  return gains;
}

Pair encode(const ImageF& linear, const Image8& reference, const std::vector<std::uint8_t>& mask) {
  Pair pair{linear.width, linear.height, fit_gains(linear, reference, mask), {}, {}, mask};
  pair.ours.resize(mask.size());
  pair.theirs.resize(mask.size());
  parallel_for(static_cast<std::size_t>(pair.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < pair.width; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        const double light = std::clamp(pair.gain[k] * linear.at(x, y)[k], 0.0, 1.0);
        pair.ours[pair.index(x, y)][k] = static_cast<float>(255 * srgb_from_linear(light));
        pair.theirs[pair.index(x, y)][k] = reference.at(x, y)[k];
      }
  });
  return pair;
}

double psnr(const Pair& pair, double masked) {
  const auto error =
      sum_masked<1>(pair.width, pair.height, pair.mask, [&](int x, int y, std::array<double, 1>& sum) {
        for (std::size_t k = 0; k < 3; ++k) {
          const double d = pair.ours[pair.index(x, y)][k] - pair.theirs[pair.index(x, y)][k];
          sum[0] += d * d;
        }
      });
  const double mean = error[0] / (3 * masked);
  return mean > 0 ? std::min(10 * std::log10(255 * 255 / mean), kBestPsnr_db) : kBestPsnr_db;
}

double luma(const std::array<float, 3>& rgb) {
  return kLuma[0] * rgb[0] + kLuma[1] * rgb[1] + kLuma[2] * rgb[2];
}

std::vector<double> lumas(const std::vector<std::array<float, 3>>& rgb) {
  std::vector<double> out(rgb.size());
  parallel_for(
      rgb.size(), [&](std::size_t i) { out[i] = luma(rgb[i]); }, 4096);
  return out;
}

// Structural similarity around one pixel; window pixels outside the mask have no weight.
double ssim_at(const Pair& pair, const std::vector<double>& a, const std::vector<double>& b, int x, int y) {
  static const auto weights = [] {
    std::array<double, kWindow + 1> w{};
    for (std::size_t i = 0; i < w.size(); ++i)
      w[i] = std::exp(-0.5 * static_cast<double>(i * i) / (kWindowSigma_px * kWindowSigma_px));
    return w;
  }();
  double sum = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (int v = std::max(y - kWindow, 0); v <= std::min(y + kWindow, pair.height - 1); ++v)
    for (int u = std::max(x - kWindow, 0); u <= std::min(x + kWindow, pair.width - 1); ++u) {
      const std::size_t i = pair.index(u, v);
      if (!pair.mask[i]) continue;
      const double w = weights[static_cast<std::size_t>(std::abs(u - x))] *
                       weights[static_cast<std::size_t>(std::abs(v - y))];
      sum += w;
      ma += w * a[i];
      mb += w * b[i];
      aa += w * a[i] * a[i];
      bb += w * b[i] * b[i];
      ab += w * a[i] * b[i];
    }
  ma /= sum;
  mb /= sum;
  const double va = std::max(aa / sum - ma * ma, 0.0), vb = std::max(bb / sum - mb * mb, 0.0),
               cov = ab / sum - ma * mb;
  const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
  return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

}  // namespace

ImageQuality compare_images(const ImageF& linear, const Image8& reference,
                            const std::vector<std::uint8_t>& mask) {
  const std::size_t count = static_cast<std::size_t>(linear.width) * static_cast<std::size_t>(linear.height);
  if (linear.width != reference.width || linear.height != reference.height || mask.size() != count)
    fail_input("image quality: expected images and mask of one size, found {} x {}, {} x {} and {} pixels",
               linear.width, linear.height, reference.width, reference.height, mask.size());
  if (linear.channels < 3 || reference.channels < 3)
    fail_input("image quality: expected at least 3 channels, found {} and {}", linear.channels,
               reference.channels);
  std::vector<std::uint8_t> counted(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* rgb = linear.pixels.data() + i * static_cast<std::size_t>(linear.channels);
    counted[i] = mask[i] && std::isfinite(rgb[0] + rgb[1] + rgb[2]);
  }
  const auto masked = static_cast<double>(std::count(counted.begin(), counted.end(), 1));
  if (masked == 0) return {};
  const Pair pair = encode(linear, reference, counted);
  const std::vector<double> ours = lumas(pair.ours), theirs = lumas(pair.theirs);
  const auto similarity = sum_masked<1>(
      pair.width, pair.height, pair.mask,
      [&](int x, int y, std::array<double, 1>& sum) { sum[0] += ssim_at(pair, ours, theirs, x, y); });
  return {psnr(pair, masked), similarity[0] / masked, masked / static_cast<double>(count), pair.gain};
}

}  // namespace hybrid::stages
