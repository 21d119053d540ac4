#include "stages/planes/coplanar_merge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "stages/planes/plane_gap.hpp"

namespace hybrid::stages {
namespace {

constexpr double kMostOffset_m = 0.02;
constexpr double kMostAngle = 5 * std::numbers::pi / 180;

bool near_plane(const PlaneFit& a, const PlaneFit& b, const SuperclusterOptions& options) {
  const double sigma = std::hypot(a.offset_sigma_m(b.centroid), b.offset_sigma_m(b.centroid));
  const double limit = std::min(kMostOffset_m, options.waviness_m + options.offset_sigmas * sigma);
  return std::abs(a.plane.distance(b.centroid)) <= limit;
}

bool coplanar(const PlaneFit& a, const PlaneFit& b, const SuperclusterOptions& options) {
  if (a.plane.normal.dot(b.plane.normal) < 0.99) return false;  // 8 degrees: the cheap test first
  const double sigma = std::hypot(a.normal_sigma_rad(), b.normal_sigma_rad());
  const double floor = options.angle_deg * std::numbers::pi / 180;
  const double limit = std::min(kMostAngle, std::max(floor, options.angle_sigmas * sigma));
  const double angle =
      std::atan2(a.plane.normal.cross(b.plane.normal).norm(), a.plane.normal.dot(b.plane.normal));
  return angle <= limit && near_plane(a, b, options) && near_plane(b, a, options);
}

}  // namespace

std::uint32_t coplanar_region(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                              const SuperclusterOptions& options, const PlaneRegions& regions,
                              const PlaneRegion& small) {
  std::uint32_t best = 0;
  for (std::size_t i = 0; i < regions.regions.size(); ++i) {
    const PlaneRegion& region = regions.regions[i];
    if (region.curved || region.squares.empty() || !coplanar(region.fit, small.fit, options)) continue;
    if (best != 0 && region.moments.weight <= regions.regions[best - 1].moments.weight) continue;
    const auto id = static_cast<std::uint32_t>(i + 1);
    const PlaneGap gap = nearest_squares(grid, rim_squares(grid, regions, id), small.squares);
    if (!is_seen_through(image, squares, region.fit.plane, gap, options)) best = id;
  }
  return best;
}

void merge_coplanar_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                            const SuperclusterOptions& options, PlaneRegions& regions) {
  std::vector<std::uint32_t> order(regions.regions.size());
  std::iota(order.begin(), order.end(), 1u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
    return regions.regions[a - 1].squares.size() > regions.regions[b - 1].squares.size();
  });
  const auto least = static_cast<std::size_t>(std::max(options.min_squares, 1));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t large = order[i];
    if (regions.regions[large - 1].curved || regions.regions[large - 1].squares.size() < least) continue;
    std::vector<std::uint32_t> large_rim = rim_squares(grid, regions, large);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        const PlaneRegion& a = regions.regions[large - 1];
        const PlaneRegion& b = regions.regions[order[j] - 1];
        if (b.curved || b.squares.empty() || !coplanar(a.fit, b.fit, options)) continue;
        const auto small_rim = rim_squares(grid, regions, order[j]);
        const PlaneGap gap = nearest_squares(grid, large_rim, small_rim);
        if (is_seen_through(image, squares, a.fit.plane, gap, options)) continue;
        // Squares where the two touched stay in the list: they are on no rim now, but do no harm.
        large_rim.insert(large_rim.end(), small_rim.begin(), small_rim.end());
        join_regions(regions, large, order[j]);
        changed = true;
      }
    }
  }
}

}  // namespace hybrid::stages
