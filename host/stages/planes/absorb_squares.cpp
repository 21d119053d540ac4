#include "stages/planes/absorb_squares.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hybrid::stages {
namespace {

constexpr double kSquareShare = 0.8;        // of a square's samples: METHOD 2's qualifying plane
constexpr double kMostSquareScatter = 1.5;  // rms over the noise expected: 3 sigmas for 20 samples
constexpr std::size_t kMuchSmaller = 4;
constexpr double kNoiseCosine = 0.05;

bool lies_on(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
             const SuperclusterOptions& options, const PlaneFit& fit, std::uint32_t square) {
  const int n = squares.square;
  const int first_row = static_cast<int>(square) / grid.cols * n;
  const int first_col = static_cast<int>(square) % grid.cols * n;
  int valid = 0, inliers = 0;
  double scatter = 0, expected = 0;
  for (int row = first_row; row < std::min(first_row + n, image.rows); ++row)
    for (int col = first_col; col < std::min(first_col + n, image.cols); ++col) {
      const Vec3 point = image.point(image.index(row, col));
      if (!std::isfinite(point.x())) continue;
      valid += 1;
      const double along = fit.plane.normal.dot(point), distance = along - fit.plane.offset_m;
      const double noise = squares.sigma_m * std::max(std::abs(along) / point.norm(), kNoiseCosine);
      if (std::abs(distance) > options.label_sigmas * noise + options.waviness_m) continue;
      inliers += 1;
      scatter += distance * distance;
      expected += std::max(noise * noise, fit.rms_m * fit.rms_m);
    }
  return inliers > 0 && inliers >= kSquareShare * valid &&
         scatter <= kMostSquareScatter * kMostSquareScatter * expected;
}

}  // namespace

void absorb_squares(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                    const SuperclusterOptions& options, PlaneRegions& regions) {
  std::vector<std::uint32_t> order;
  std::vector<std::size_t> size;  // at the start: who may take from whom does not depend on progress
  for (std::size_t i = 0; i < regions.regions.size(); ++i) {
    size.push_back(regions.regions[i].squares.size());
    if (!regions.regions[i].curved && size.back() > 0) order.push_back(static_cast<std::uint32_t>(i + 1));
  }
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return size[a - 1] > size[b - 1]; });

  for (const std::uint32_t id : order) {
    std::vector<std::uint32_t> front;
    for (const std::uint32_t square : regions.regions[id - 1].squares)
      if (regions.of_square[square] == id) front.push_back(square);
    for (std::size_t next = 0; next < front.size(); ++next)
      for (int direction = 0; direction < 4; ++direction) {
        const std::int64_t neighbour = grid.neighbour(front[next], direction);
        if (neighbour == SquareGrid::kNone) continue;
        const auto other = static_cast<std::uint32_t>(neighbour);
        const std::uint32_t owner = regions.of_square[other];
        if (owner == id || (owner != 0 && kMuchSmaller * size[owner - 1] > size[id - 1])) continue;
        if (squares.squares[other].state == SQUARE_UNDERSAMPLED ||
            !lies_on(image, squares, grid, options, regions.regions[id - 1].fit, other))
          continue;
        regions.of_square[other] = id;
        front.push_back(other);
      }
  }
  for (PlaneRegion& region : regions.regions) region.squares.clear();
  for (std::size_t i = 0; i < regions.of_square.size(); ++i)
    if (regions.of_square[i] != 0)
      regions.regions[regions.of_square[i] - 1].squares.push_back(static_cast<std::uint32_t>(i));
}

}  // namespace hybrid::stages
