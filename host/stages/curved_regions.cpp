#include "stages/curved_regions.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostSamples = 4000;  // of a region in the quadratic fit
constexpr std::size_t kFewestHeights = 30;
constexpr double kLeastGain = 30;           // fall of chi2 for 3 more parameters
constexpr double kLeastShareGained = 0.01;  // of the squared residuals
constexpr double kCreaseFrom = 2.5 * std::numbers::pi / 180, kCreaseTo = 30 * std::numbers::pi / 180;
constexpr double kBendSigmas = 4;
constexpr double kBulgeScatter = 0.3;    // rms of a parabola about its mean, over its height: 2 / (3 sqrt 5)
constexpr double kMostBulge = 2;         // times the scatter
constexpr std::size_t kWidestFacet = 8;  // squares; a strip w squares wide has w / 2 squares per rim edge
constexpr std::size_t kMuchLarger = 8;

// Every stride-th sample of the region's squares that lies on its plane.
PlaneHeights heights(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                     const SuperclusterOptions& options, const PlaneRegion& region) {
  const int n = squares.square;
  const std::size_t total = region.squares.size() * static_cast<std::size_t>(n * n);
  const std::size_t stride = (total + kMostSamples - 1) / kMostSamples;
  const double noise = options.label_sigmas * std::max(squares.sigma_m, region.fit.rms_m);
  const auto on_plane = [&](int row, int col) {
    if (image.wraps) col = (col + image.cols) % image.cols;
    if (row < 0 || row >= image.rows || col < 0 || col >= image.cols) return false;
    const double height = region.fit.plane.distance(image.point(image.index(row, col)));
    return std::abs(height) <= noise + options.waviness_m;  // false for NaN
  };
  PlaneHeights samples;
  for (std::size_t at = 0; at < total; at += stride) {
    const std::uint32_t square = region.squares[at / static_cast<std::size_t>(n * n)];
    const int inside = static_cast<int>(at % static_cast<std::size_t>(n * n));
    const int row = static_cast<int>(square) / grid.cols * n + inside / n;
    const int col = static_cast<int>(square) % grid.cols * n + inside % n;
    if (row >= image.rows || col >= image.cols || !on_plane(row, col)) continue;
    const Vec3 point = image.point(image.index(row, col)), arm = point - region.fit.centroid;
    samples.add(
        {arm.dot(region.fit.axis[0]), arm.dot(region.fit.axis[1]), region.fit.plane.distance(point)},
        {on_plane(row, col + 1), on_plane(row + 1, col), on_plane(row, col - 1), on_plane(row - 1, col)});
  }
  return samples;
}

struct HeightFits {
  double linear = 0, quadratic = 0;  // sums of squared residuals
  double curvature = 0;              // 1/m, the larger principal one
  bool determined = false;
};

// height = c0 + c1 a + c2 b + c3 a^2 + c4 a b + c5 b^2 by least squares, and its linear part alone.
HeightFits fit_quadratic(const std::vector<Vec3>& heights) {
  HeightFits fits;
  Vec2 scale = Vec2::Zero();  // of its own for each axis: strips are narrow
  for (const Vec3& s : heights) scale = scale.cwiseMax(s.head<2>().cwiseAbs());
  if (!(scale.minCoeff() > 0)) return fits;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Vec6 right = Vec6::Zero();
  double squares = 0;
  for (const Vec3& s : heights) {
    const double a = s.x() / scale.x(), b = s.y() / scale.y();
    const Vec6 row = (Vec6() << 1, a, b, a * a, a * b, b * b).finished();
    normal += row * row.transpose();
    right += row * s.z();
    squares += s.z() * s.z();
  }
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal);
  // Samples in two lines fix no quadratic.
  fits.determined = solver.vectorD().minCoeff() > 1e-3 * solver.vectorD().maxCoeff();
  const Vec6 quadratic = solver.solve(right);
  const Vec3 linear = normal.topLeftCorner<3, 3>().ldlt().solve(right.head<3>());
  fits.linear = squares - linear.dot(right.head<3>());
  fits.quadratic = squares - quadratic.dot(right);
  const double aa = 2 * quadratic[3] / (scale.x() * scale.x()),
               bb = 2 * quadratic[5] / (scale.y() * scale.y());
  const double ab = quadratic[4] / (scale.x() * scale.y());
  fits.curvature = 0.5 * (std::abs(aa + bb) + std::hypot(aa - bb, 2 * ab));
  return fits;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Square b outside meets square a of the region in a kink of less than 30 degrees without a step.
bool in_contact(const RangeImage& image, const SquarePlanes& squares, const SuperclusterOptions& options,
                const SquareRecord& a, const SquareRecord& b) {
  if (b.state != SQUARE_PLANAR) return false;
  const Vec3 na = square_normal(a), nb = square_normal(b);
  const double angle = angle_between(na, nb);
  const double sigma = std::hypot(a.sigma_normal, b.sigma_normal);
  if (angle > kCreaseTo + options.angle_sigmas * sigma) return false;
  const Vec3 step = square_centroid(b) - square_centroid(a);
  const double distance = step.norm(), range = square_centroid(a).norm();
  const double angular = std::max(image.elevation_step_rad(), image.azimuth_step_rad());
  const double cosine = std::max(std::abs(na.dot(square_centroid(a))) / range, 0.1);
  const double noise = options.offset_sigmas * squares.sigma_m;
  if (distance > options.distance_factor * squares.square * range * angular / cosine + noise) return false;
  return std::max(std::abs(step.dot(na)), std::abs(step.dot(nb))) < distance * std::sin(angle) + noise;
}

// A square that straddles a small step is turned, but the one beyond it is parallel again; one that straddles
// a corner is turned a little, the one beyond it far more than a curved surface would go on.
bool straddles(const SquarePlanes& squares, const SquareGrid& grid, const Vec3& normal, std::size_t square,
               int direction) {
  const std::int64_t beyond = grid.neighbour(square, direction);
  if (beyond == SquareGrid::kNone) return false;
  const SquareRecord& after = squares.squares[static_cast<std::size_t>(beyond)];
  if (after.state != SQUARE_PLANAR) return false;
  const double here = angle_between(normal, square_normal(squares.squares[square]));
  const double there = angle_between(normal, square_normal(after));
  return there < 0.5 * here || there > std::max(4 * here, kCreaseTo);
}

// Most of the rim is in contact with squares that, on the mean, turn away (or all towards): one such normal
// may be noise, their mean is not.
bool is_facet(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
              const SuperclusterOptions& options, const PlaneRegions& regions, std::uint32_t id) {
  const PlaneRegion& region = regions.regions[id - 1];
  const Vec3& normal = region.fit.plane.normal;
  int rim = 0, contacts = 0;
  double bend = 0, reach = 0, variance = 0;
  for (const std::uint32_t square : region.squares)
    for (int direction = 0; direction < 4; ++direction) {
      const std::int64_t neighbour = grid.neighbour(square, direction);
      if (neighbour == SquareGrid::kNone) continue;
      const auto other = static_cast<std::size_t>(neighbour);
      const std::uint32_t owner = regions.of_square[other];
      if (owner == id) continue;
      rim += 1;
      if (owner != 0 && regions.regions[owner - 1].squares.size() > kMuchLarger * region.squares.size())
        continue;
      const SquareRecord &here = squares.squares[square], &next = squares.squares[other];
      if (!in_contact(image, squares, options, here, next) ||
          straddles(squares, grid, normal, other, direction))
        continue;
      contacts += 1;
      const Vec3 step = square_centroid(next) - square_centroid(here);
      const Vec3 outward = (step - step.dot(normal) * normal).normalized();
      bend += square_normal(next).dot(outward);
      reach += step.norm();
      variance += next.sigma_normal * next.sigma_normal;
    }
  // A wide region bends visibly itself when it is curved: bends() decides.
  if (region.squares.size() > kWidestFacet / 2 * static_cast<std::size_t>(rim)) return false;
  // If its neighbours' turn went on across the region, it would bulge, and scatter about its plane by 0.3 of
  // that; when it scatters less, what turns at its rim are the edges of a flat face.
  const double width = std::sqrt(12 * region.fit.spread[0] / region.fit.weight);
  const double bulge = std::abs(bend) / std::max(reach, 1e-9) * width * width / 8;
  if (kBulgeScatter * bulge > kMostBulge * region.fit.rms_m) return false;
  return contacts > options.max_crease_share * rim && std::abs(bend) > kCreaseFrom * contacts &&
         std::abs(bend) > kBendSigmas * std::sqrt(variance);
}

}  // namespace

bool can_bend(const std::vector<Vec3>& heights) {
  return heights.size() >= kFewestHeights && fit_quadratic(heights).determined;
}

bool bends(const std::vector<Vec3>& heights, double min_curvature) {
  if (heights.size() < kFewestHeights) return false;
  const HeightFits fits = fit_quadratic(heights);
  if (!fits.determined) return false;
  const double variance =
      std::max(fits.quadratic, 1e-12 * fits.linear) / static_cast<double>(heights.size() - 6);
  const double fall = fits.linear - fits.quadratic;
  return variance > 0 && fall >= kLeastGain * variance && fall >= kLeastShareGained * fits.linear &&
         fits.curvature > min_curvature;
}

void PlaneHeights::add(const Vec3& height, const std::array<bool, 4>& neighbours) {
  all.push_back(height);
  for (std::size_t side = 0; side < neighbours.size(); ++side)
    if (neighbours[side]) trimmed[side].push_back(height);
  if (neighbours[0] && neighbours[1] && neighbours[2] && neighbours[3]) inner.push_back(height);
}

bool PlaneHeights::bend(double min_curvature) const {
  const auto may_bend = [&](const std::vector<Vec3>& part) {
    return !can_bend(part) || bends(part, min_curvature);
  };
  return bends(all, min_curvature) && may_bend(inner) &&
         std::all_of(trimmed.begin(), trimmed.end(), may_bend);
}

void mark_curved_regions(const RangeImage& image, const SquarePlanes& squares, const SquareGrid& grid,
                         const SuperclusterOptions& options, PlaneRegions& regions) {
  struct Verdict {
    bool facet = false, curved = false;
  };
  std::vector<Verdict> verdicts(regions.regions.size());
  parallel_for(regions.regions.size(), [&](std::size_t i) {
    const PlaneRegion& region = regions.regions[i];
    if (region.curved || region.squares.empty()) return;
    Verdict& verdict = verdicts[i];
    verdict.facet = is_facet(image, squares, grid, options, regions, static_cast<std::uint32_t>(i + 1));
    verdict.curved = verdict.facet;
    if (verdict.facet) return;
    verdict.curved = heights(image, squares, grid, options, region).bend(options.min_curvature);
  });
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    regions.regions[i].curved |= verdicts[i].curved;
    regions.regions[i].facet |= verdicts[i].facet;
  }
}

}  // namespace hybrid::stages
