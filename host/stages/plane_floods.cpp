#include "stages/plane_floods.hpp"

#include <algorithm>
#include <cmath>

#include "shared/params_window_planes.h"
#include "stages/sample_marks.hpp"
#include "stages/sparse_seeds.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFloodSigmas = 3;
constexpr double kLeastCosine = 0.02;  // as window_planes' seeds
constexpr int kSparseReach = 2;        // samples
constexpr std::uint32_t kInside = 0xffffffffu;

}  // namespace

std::vector<std::uint32_t> PlaneFlooder::seed_samples(const WindowSeed& seed) const {
  if (seed.shape == kSparseSeed) return sparse_seed_samples(image_, use_, noise_, seed.sample);
  const int row = static_cast<int>(seed.sample) / image_.cols,
            col = static_cast<int>(seed.sample) % image_.cols;
  const std::uint32_t shape = seed.shape;
  std::vector<std::uint32_t> samples;
  for (int r = row; r < row + static_cast<int>(WINDOW_ROWS(shape)); ++r)
    for (int c = col; c < col + static_cast<int>(WINDOW_COLS(shape)); ++c)
      if (const auto i = static_cast<std::uint32_t>(image_.index(r, c)); use_[i] == kFree)
        samples.push_back(i);
  return samples;
}

std::vector<std::uint32_t> PlaneFlooder::samples(const WindowSeed& seed, const Tile& limits) const {
  const int cols = image_.cols, reach = seed.shape == kSparseSeed ? kSparseReach : 1;
  std::vector<std::uint32_t> samples = seed_samples(seed);
  // kInside, or the number of the fit that rejected the sample: the same fit need not be asked again.
  thread_local SampleMarks marks;
  marks.clear();
  for (const std::uint32_t i : samples) marks.of(i) = kInside;
  RayPlane plane(image_.point(samples.empty() ? seed.sample : samples[0]));
  for (const std::uint32_t i : samples) plane.add(image_.point(i));
  if (!plane.solve()) return {};

  const auto lies_on = [&](const Vec3& point) {
    const double range = point.norm();
    const auto [residual, cosine] = plane.at(point, range);
    // The plane's own uncertainty is looked at only where it could matter.
    if (!(cosine >= kLeastCosine)) return false;
    const double limit = kFloodSigmas * noise_.at(range, cosine);
    return std::abs(residual) <= limit ||
           std::abs(residual) <= limit * std::sqrt(1 + plane.prediction_variance(point));
  };
  std::size_t fitted = plane.samples();
  std::uint32_t fit = 1;
  for (std::size_t next = 0; next < samples.size(); ++next) {
    const int row = static_cast<int>(samples[next]) / cols;
    const int col = static_cast<int>(samples[next]) % cols;
    for (int r = std::max(row - reach, limits.row); r <= std::min(row + reach, limits.row + limits.rows - 1);
         ++r)
      for (int step = -reach; step <= reach; ++step) {
        int c = col + step;
        if (image_.wraps) c = (c + cols) % cols;
        if (c < limits.col || c >= limits.col + limits.cols) continue;
        const auto i = static_cast<std::uint32_t>(image_.index(r, c));
        if (use_[i] != kFree) continue;
        std::uint32_t& mark = marks.of(i);
        if (mark == kInside || mark == fit) continue;
        const Vec3 point = image_.point(i);
        mark = lies_on(point) ? kInside : fit;
        if (mark != kInside) continue;
        samples.push_back(i);
        plane.add(point);
        // A refit per tenth of growth: the plane is always known to where it is tested.
        if (10 * plane.samples() < 11 * fitted) continue;
        if (!plane.solve()) return {};
        fitted = plane.samples();
        fit += 1;
      }
  }
  // Samples taken while the plane was uncertain leave when all of them contradict it.
  if (!plane.solve()) return {};
  std::erase_if(samples, [&](std::uint32_t i) {
    const Vec3 point = image_.point(i);
    const double range = point.norm();
    const auto [residual, cosine] = plane.at(point, range);
    return !(std::abs(residual) <= kFloodSigmas * noise_.at(range, cosine)) || !(cosine >= kLeastCosine);
  });
  return samples;
}

PlaneFlood PlaneFlooder::flood(const WindowSeed& seed, const Tile& limits) const {
  PlaneFlood result;
  result.samples = samples(seed, limits);
  if (result.samples.empty()) return {};
  std::sort(result.samples.begin(), result.samples.end());
  result.plane = RayPlane(image_.point(result.samples[0]));
  for (const std::uint32_t i : result.samples) result.plane.add(image_.point(i));
  if (!result.plane.solve()) return {};
  for (const std::uint32_t i : result.samples) {
    const Vec3 point = image_.point(i);
    const double range = point.norm();
    const auto [residual, cosine] = result.plane.at(point, range);
    const double sigmas = residual / noise_.at(range, cosine);
    result.chi2 += sigmas * sigmas;
  }
  return result;
}

}  // namespace hybrid::stages
