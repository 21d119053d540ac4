#include "stages/coplanar_merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace hybrid::stages {
namespace {

constexpr double kMostOffset_m = 0.02;
constexpr double kMostAngle = 5 * std::numbers::pi / 180;
constexpr double kMostSeenThrough = 0.1;  // of the samples between two parts
constexpr std::size_t kMostRim = 256;     // squares of a rim in the search for the nearest pair

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

// Squares of the region that have a neighbour outside it.
std::vector<std::uint32_t> rim(const SquareGrid& grid, const PlaneRegions& regions, std::uint32_t id) {
  std::vector<std::uint32_t> squares;
  for (const std::uint32_t square : regions.regions[id - 1].squares)
    for (int direction = 0; direction < 4; ++direction) {
      const std::int64_t other = grid.neighbour(square, direction);
      if (other == SquareGrid::kNone || regions.of_square[static_cast<std::size_t>(other)] == id) continue;
      squares.push_back(square);
      break;
    }
  return squares;
}

struct Gap {
  int row = 0, col = 0;    // the square it starts from
  int rows = 0, cols = 0;  // to the square it ends at; columns the short way round
};

// The nearest pair among at most kMostRim squares of each rim, evenly chosen.
Gap nearest_squares(const SquareGrid& grid, const std::vector<std::uint32_t>& from,
                    const std::vector<std::uint32_t>& to) {
  Gap best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  const std::size_t from_stride = (from.size() + kMostRim - 1) / kMostRim;
  const std::size_t to_stride = (to.size() + kMostRim - 1) / kMostRim;
  for (std::size_t i = 0; i < from.size(); i += from_stride)
    for (std::size_t j = 0; j < to.size(); j += to_stride) {
      const std::uint32_t a = from[i], b = to[j];
      const int row = static_cast<int>(a) / grid.cols, col = static_cast<int>(a) % grid.cols;
      const int rows = static_cast<int>(b) / grid.cols - row;
      int cols = static_cast<int>(b) % grid.cols - col;
      if (grid.wraps && 2 * cols > grid.cols) cols -= grid.cols;
      if (grid.wraps && 2 * cols < -grid.cols) cols += grid.cols;
      const std::int64_t distance =
          static_cast<std::int64_t>(rows) * rows + static_cast<std::int64_t>(cols) * cols;
      if (distance < least) {
        least = distance;
        best = {row, col, rows, cols};
      }
    }
  return best;
}

// Share of the samples along the gap whose ray went through the plane.
double seen_through(const RangeImage& image, const SquarePlanes& squares, const Plane& plane, const Gap& gap,
                    const SuperclusterOptions& options) {
  const int n = squares.square;
  const int steps = std::max(std::abs(gap.rows), std::abs(gap.cols)) * n;
  int through = 0, seen = 0;
  for (int i = 0; i <= steps; ++i) {
    const int row = gap.row * n + n / 2 + gap.rows * n * i / std::max(steps, 1);
    int col = gap.col * n + n / 2 + gap.cols * n * i / std::max(steps, 1);
    if (image.wraps) col = (col % image.cols + image.cols) % image.cols;
    if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) continue;
    const Vec3 point = image.point(image.index(row, col));
    if (!std::isfinite(point.x())) continue;
    seen += 1;
    through += plane.distance(point) < -(kMostOffset_m + options.label_sigmas * squares.sigma_m);
  }
  return seen ? static_cast<double>(through) / seen : 0;
}

void take(PlaneRegions& regions, std::uint32_t winner, std::uint32_t loser) {
  PlaneRegion& a = regions.regions[winner - 1];
  PlaneRegion& b = regions.regions[loser - 1];
  for (const std::uint32_t square : b.squares) regions.of_square[square] = winner;
  a.squares.insert(a.squares.end(), b.squares.begin(), b.squares.end());
  a.moments.merge(b.moments);
  a.fit = fit_plane(a.moments);
  b = PlaneRegion();
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
    const Gap gap = nearest_squares(grid, rim(grid, regions, id), small.squares);
    if (seen_through(image, squares, region.fit.plane, gap, options) <= kMostSeenThrough) best = id;
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
    std::vector<std::uint32_t> large_rim = rim(grid, regions, large);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        const PlaneRegion& a = regions.regions[large - 1];
        const PlaneRegion& b = regions.regions[order[j] - 1];
        if (b.curved || b.squares.empty() || !coplanar(a.fit, b.fit, options)) continue;
        const auto small_rim = rim(grid, regions, order[j]);
        const Gap gap = nearest_squares(grid, large_rim, small_rim);
        if (seen_through(image, squares, a.fit.plane, gap, options) > kMostSeenThrough) continue;
        // Squares where the two touched stay in the list: they are on no rim now, but do no harm.
        large_rim.insert(large_rim.end(), small_rim.begin(), small_rim.end());
        take(regions, large, order[j]);
        changed = true;
      }
    }
  }
}

}  // namespace hybrid::stages
