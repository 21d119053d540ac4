#include "stages/sparse_seeds.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "lib/random.h"

namespace hybrid::stages {
namespace {

constexpr int kWindow = 8, kStride = 4;
constexpr std::size_t kFewest = 12;
constexpr double kLeastShare = 0.4;  // of the free samples
constexpr std::uint32_t kTestPlanes = 32, kSeed = 1;
constexpr double kSigmas = 3;
constexpr double kLeastCosine = 0.02;  // as window_planes' seeds
constexpr double kSliver = 1e-2;       // sine of the angle between two sides of a test triangle

std::vector<std::uint32_t> free_in_window(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                          std::uint32_t corner) {
  const int row = static_cast<int>(corner) / image.cols, col = static_cast<int>(corner) % image.cols;
  std::vector<std::uint32_t> samples;
  for (int r = row; r < std::min(row + kWindow, image.rows); ++r)
    for (int c = col; c < std::min(col + kWindow, image.cols); ++c)
      if (const std::size_t i = image.index(r, c); use[i] == kFree)
        samples.push_back(static_cast<std::uint32_t>(i));
  return samples;
}

// |measured - predicted range| on the plane through `a` with this unit normal, in sigmas.
bool lies_on(const RangeNoise& noise, const Vec3& normal, double offset, const Vec3& point) {
  const double range = point.norm(), cosine = normal.dot(point) / range;
  return std::abs(cosine) >= kLeastCosine &&
         std::abs(range - offset / cosine) <= kSigmas * noise.at(range, std::abs(cosine));
}

}  // namespace

std::vector<std::uint32_t> sparse_seed_samples(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                               const RangeNoise& noise, std::uint32_t corner) {
  const auto samples = free_in_window(image, use, corner);
  if (samples.size() < kFewest) return {};
  std::vector<Vec3> points;
  for (const std::uint32_t i : samples) points.push_back(image.point(i));
  const auto count = static_cast<std::uint32_t>(points.size());
  std::size_t most = std::max(kFewest, static_cast<std::size_t>(std::ceil(kLeastShare * count))) - 1;
  std::vector<std::uint32_t> best;
  for (std::uint32_t k = 0; k < kTestPlanes; ++k) {
    const Vec3 &a = points[random_below(kSeed, corner, 3 * k, count)],
               &b = points[random_below(kSeed, corner, 3 * k + 1, count)],
               &c = points[random_below(kSeed, corner, 3 * k + 2, count)];
    const Vec3 normal = (b - a).cross(c - a);
    const double area = normal.norm();
    if (!(area > kSliver * (b - a).norm() * (c - a).norm())) continue;
    std::vector<std::uint32_t> on;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (lies_on(noise, normal / area, normal.dot(a) / area, points[i])) on.push_back(samples[i]);
    if (on.size() <= most) continue;
    most = on.size();
    best = std::move(on);
  }
  return best;
}

std::vector<WindowSeed> find_sparse_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                          const RangeNoise& noise) {
  const auto rows = static_cast<std::size_t>((image.rows + kStride - 1) / kStride);
  std::vector<std::vector<WindowSeed>> of_row(rows);
  parallel_for(rows, [&](std::size_t row) {
    for (int col = 0; col < image.cols; col += kStride) {
      const auto corner = static_cast<std::uint32_t>(image.index(static_cast<int>(row) * kStride, col));
      const auto samples = sparse_seed_samples(image, use, noise, corner);
      if (!samples.empty()) of_row[row].push_back({corner, kSparseSeed, samples[samples.size() / 2]});
    }
  });
  std::vector<WindowSeed> seeds;
  for (const auto& list : of_row) seeds.insert(seeds.end(), list.begin(), list.end());
  return seeds;
}

}  // namespace hybrid::stages
