#include "stages/planes/plane_gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hybrid::stages {
namespace {

constexpr double kBehind_m = 0.02;            // of the plane, and the noise
constexpr double kMostThroughGap = 0.1;       // of the samples between two parts
constexpr std::size_t kMostRimSquares = 256;  // squares of a rim in the search for the nearest pair

}  // namespace

std::vector<std::uint32_t> rim_squares(const SquareGrid& grid, const PlaneRegions& regions,
                                       std::uint32_t id) {
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

PlaneGap nearest_squares(const SquareGrid& grid, const std::vector<std::uint32_t>& from,
                         const std::vector<std::uint32_t>& to) {
  PlaneGap best;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  const std::size_t from_stride = (from.size() + kMostRimSquares - 1) / kMostRimSquares;
  const std::size_t to_stride = (to.size() + kMostRimSquares - 1) / kMostRimSquares;
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

double seen_through_m(const SquarePlanes& squares, const SuperclusterOptions& options) {
  return kBehind_m + options.label_sigmas * squares.sigma_m;
}

bool is_seen_through(const RangeImage& image, const SquarePlanes& squares, const Plane& plane,
                     const PlaneGap& gap, const SuperclusterOptions& options) {
  const int n = squares.square;
  const int steps = std::max(std::abs(gap.rows), std::abs(gap.cols)) * n;
  const double behind_m = seen_through_m(squares, options);
  int through = 0, seen = 0;
  for (int i = 0; i <= steps; ++i) {
    const int row = gap.row * n + n / 2 + gap.rows * n * i / std::max(steps, 1);
    int col = gap.col * n + n / 2 + gap.cols * n * i / std::max(steps, 1);
    col = image.wrapped(col);
    if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) continue;
    const Vec3 point = image.point(image.index(row, col));
    if (!std::isfinite(point.x())) continue;
    seen += 1;
    through += plane.distance(point) < -behind_m;
  }
  return through > kMostThroughGap * seen;
}

}  // namespace hybrid::stages
