#include "stages/planes/plane_regions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace hybrid::stages {
namespace {

// Fewer squares than this fix no plane worth competing for samples.
constexpr std::size_t kLeastSquares = 3;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// A square's plane and the region's agree: offset at the square's centroid and angle between the normals.
bool agrees(const PlaneFit& region, const SquareRecord& square, const SuperclusterOptions& options) {
  const Vec3 centroid = square_centroid(square);
  const double square_sigma = square.rms / std::sqrt(static_cast<double>(square.inliers));
  const double offset_sigma = std::hypot(region.offset_sigma_m(centroid), square_sigma);
  if (std::abs(region.plane.distance(centroid)) > options.waviness_m + options.offset_sigmas * offset_sigma)
    return false;
  const double angle_sigma = std::hypot(region.normal_sigma_rad(), static_cast<double>(square.sigma_normal));
  const double limit = std::max(radians(options.angle_deg), options.angle_sigmas * angle_sigma);
  const Vec3 normal = square_normal(square);
  const double angle = std::atan2(region.plane.normal.cross(normal).norm(), region.plane.normal.dot(normal));
  return angle <= limit;
}

// Straight above a scanner a column's samples are nearer to each other than they are noisy: the plane that
// holds their line of sight fits them best, but misses their ranges by more than these vary.
bool is_edge_on(const PlaneRegion& region) {
  const Vec3 sight = region.fit.centroid.normalized();
  const double cosine = region.fit.plane.normal.dot(sight);
  const double along_m2 = sight.dot(region.moments.scatter * sight) / region.moments.weight;
  return region.fit.rms_m * region.fit.rms_m > cosine * cosine * along_m2;
}

float link(const SquareLinks& links, const SquareGrid& grid, std::size_t square, int direction) {
  const std::int64_t other = grid.neighbour(square, direction);
  if (other == SquareGrid::kNone) return -1;
  const bool forward = direction == SquareGrid::kRight || direction == SquareGrid::kLower;
  const std::size_t owner = forward ? square : static_cast<std::size_t>(other);
  const bool vertical = direction == SquareGrid::kLower || direction == SquareGrid::kUpper;
  return links[2 * owner + (vertical ? 1 : 0)];
}

// Linked squares, most links first, then the smallest mean cost, then the smaller index.
std::vector<std::uint32_t> seeds(const SquareGrid& grid, const SquareLinks& links) {
  std::vector<float> key(grid.count());
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < grid.count(); ++i) {
    int count = 0;
    float sum = 0;
    for (int direction = 0; direction < 4; ++direction)
      if (const float cost = link(links, grid, i, direction); cost >= 0) {
        count += 1;
        sum += cost;
      }
    if (count == 0) continue;
    key[i] = static_cast<float>(-count) + sum / static_cast<float>(count);
    order.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
  return order;
}

PlaneRegion grow_from(std::uint32_t seed, const SquarePlanes& squares, const SquareGrid& grid,
                      const SquareLinks& links, const SuperclusterOptions& options, std::uint32_t id,
                      std::vector<std::uint32_t>& of_square) {
  PlaneRegion region;
  region.squares = {seed};
  region.moments = square_moments(squares.squares[seed]);
  region.fit = fit_plane(region.moments);
  of_square[seed] = id;
  for (std::size_t next = 0; next < region.squares.size(); ++next) {
    const std::uint32_t square = region.squares[next];
    for (int direction = 0; direction < 4; ++direction) {
      if (link(links, grid, square, direction) < 0) continue;
      const auto other = static_cast<std::uint32_t>(grid.neighbour(square, direction));
      if (of_square[other] != 0 || !agrees(region.fit, squares.squares[other], options)) continue;
      of_square[other] = id;
      region.squares.push_back(other);
      region.moments.merge(square_moments(squares.squares[other]));
      // A refit per square while the plane is still uncertain, then per 10 % of growth.
      if (region.squares.size() <= 8 || region.moments.weight > 1.1 * region.fit.weight)
        region.fit = fit_plane(region.moments);
    }
  }
  return region;
}

// Squares taken while the plane was uncertain leave when the final plane contradicts them.
void prune(const SquarePlanes& squares, const SuperclusterOptions& options, PlaneRegion& region,
           std::vector<std::uint32_t>& of_square) {
  region.fit = fit_plane(region.moments);
  std::vector<std::uint32_t> kept;
  PlaneMoments moments;
  for (const std::uint32_t square : region.squares)
    if (agrees(region.fit, squares.squares[square], options)) {
      kept.push_back(square);
      moments.merge(square_moments(squares.squares[square]));
    } else {
      of_square[square] = 0;
    }
  region.squares = std::move(kept);
  region.moments = moments;
  if (moments.weight > 0) region.fit = fit_plane(moments);
}

}  // namespace

PlaneMoments square_moments(const SquareRecord& square) {
  PlaneMoments moments;
  moments.weight = square.inliers;
  moments.mean = square_centroid(square);
  const float* s = square.scatter;
  moments.scatter << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return moments;
}

PlaneRegions grow_regions(const SquarePlanes& squares, const SquareGrid& grid, const SquareLinks& links,
                          const SuperclusterOptions& options) {
  PlaneRegions result;
  result.of_square.assign(grid.count(), 0);
  for (const std::uint32_t seed : seeds(grid, links)) {
    if (result.of_square[seed] != 0) continue;
    const auto id = static_cast<std::uint32_t>(result.regions.size() + 1);
    PlaneRegion region = grow_from(seed, squares, grid, links, options, id, result.of_square);
    prune(squares, options, region, result.of_square);
    if (region.squares.size() < kLeastSquares || is_edge_on(region))
      for (const std::uint32_t square : region.squares) result.of_square[square] = 0;
    else
      result.regions.push_back(std::move(region));
  }
  return result;
}

void join_regions(PlaneRegions& regions, std::uint32_t winner, std::uint32_t loser) {
  PlaneRegion& a = regions.regions[winner - 1];
  PlaneRegion& b = regions.regions[loser - 1];
  for (const std::uint32_t square : b.squares) regions.of_square[square] = winner;
  a.squares.insert(a.squares.end(), b.squares.begin(), b.squares.end());
  a.moments.merge(b.moments);
  a.fit = fit_plane(a.moments);
  b = PlaneRegion();
}

}  // namespace hybrid::stages
