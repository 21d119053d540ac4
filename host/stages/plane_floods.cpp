#include "stages/plane_floods.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "shared/params_window_planes.h"

namespace hybrid::stages {
namespace {

constexpr double kFloodSigmas = 3;
constexpr double kLeastCosine = 0.02;  // as window_planes' seeds

}  // namespace

PlaneFlood PlaneFlooder::flood(const WindowSeed& seed, const Tile& limits) const {
  PlaneFlood result;
  const int cols = image_.cols;
  const int seed_row = static_cast<int>(seed.sample) / cols, seed_col = static_cast<int>(seed.sample) % cols;
  const std::uint32_t shape = seed.shape;
  std::unordered_set<std::uint32_t> inside;
  RayPlane plane(image_.point(seed.sample));
  for (int row = seed_row; row < seed_row + static_cast<int>(WINDOW_ROWS(shape)); ++row)
    for (int col = seed_col; col < seed_col + static_cast<int>(WINDOW_COLS(shape)); ++col) {
      const auto i = static_cast<std::uint32_t>(image_.index(row, col));
      if (use_[i] != kFree) continue;
      plane.add(image_.point(i));
      result.samples.push_back(i);
      inside.insert(i);
    }
  if (!plane.solve()) return {};

  const auto lies_on = [&](const Vec3& point) {
    const double limit = kFloodSigmas * sigma_m_ * std::sqrt(1 + plane.prediction_variance(point));
    return std::abs(plane.residual_m(point)) <= limit && plane.cosine(point) >= kLeastCosine;
  };
  std::size_t fitted = plane.samples();
  for (std::size_t next = 0; next < result.samples.size(); ++next) {
    const int row = static_cast<int>(result.samples[next]) / cols;
    const int col = static_cast<int>(result.samples[next]) % cols;
    for (int r = std::max(row - 1, limits.row); r <= std::min(row + 1, limits.row + limits.rows - 1); ++r)
      for (int step = -1; step <= 1; ++step) {
        int c = col + step;
        if (image_.wraps) c = (c + cols) % cols;
        if (c < limits.col || c >= limits.col + limits.cols) continue;
        const auto i = static_cast<std::uint32_t>(image_.index(r, c));
        if (use_[i] != kFree || inside.contains(i)) continue;
        const Vec3 point = image_.point(i);
        if (!lies_on(point)) continue;
        inside.insert(i);
        result.samples.push_back(i);
        plane.add(point);
        // A refit per tenth of growth: the plane is always known to where it is tested.
        if (10 * plane.samples() < 11 * fitted) continue;
        if (!plane.solve()) return {};
        fitted = plane.samples();
      }
  }
  // Samples taken while the plane was uncertain leave when all of them contradict it.
  if (!plane.solve()) return {};
  std::erase_if(result.samples, [&](std::uint32_t i) {
    const Vec3 point = image_.point(i);
    return !(std::abs(plane.residual_m(point)) <= kFloodSigmas * sigma_m_) ||
           !(plane.cosine(point) >= kLeastCosine);
  });
  std::sort(result.samples.begin(), result.samples.end());
  result.plane = RayPlane(image_.point(seed.sample));
  for (const std::uint32_t i : result.samples) result.plane.add(image_.point(i));
  if (!result.plane.solve()) return {};
  return result;
}

}  // namespace hybrid::stages
