#include "score/measure/opening_rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "score/measure/polygon.hpp"

namespace score {
namespace {

// Median angle between samples next to each other in a row.
double step_rad(const LabelledGrid& grid) {
  std::vector<double> angles;
  for (int row = 0; row < grid.rows; row += 7)
    for (int col = 0; col + 1 < grid.cols; col += 5) {
      const std::size_t i = grid.index(row, col);
      if (grid.source[i] == kNoSource || grid.source[i + 1] == kNoSource) continue;
      const Vec3 a = grid.point[i].cast<double>(), b = grid.point[i + 1].cast<double>();
      angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  if (angles.empty()) return 0;
  std::nth_element(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2),
                   angles.end());
  return angles[angles.size() / 2];
}

}  // namespace

void count_opening_rays(const LabelledGrid& grid, const Similarity& world_from_scan,
                        const std::vector<TrueOpening>& truth, OpeningScore& score) {
  if (grid.point.empty()) return;
  const double step = step_rad(grid);
  const Vec3 scanner = world_from_scan.translation;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Plane plane = plane_of_ring(truth[k].ring);
    const PlanePolygon polygon(plane, {truth[k].ring});
    const double before = plane.normal.dot(scanner) - plane.offset_m;
    std::int64_t rays = 0;
    double spacing = 0;
    for (std::size_t i = 0; i < grid.point.size(); ++i) {
      if (grid.source[i] == kNoSource) continue;
      const Vec3 point = world_from_scan * grid.point[i].cast<double>();
      const double behind = plane.normal.dot(point) - plane.offset_m;
      if ((before > 0) == (behind > 0)) continue;
      const Vec3 at = scanner + before / (before - behind) * (point - scanner);
      const double cosine = std::abs(before - behind) / (point - scanner).norm();
      if (cosine < std::cos(kSteepestDeg * M_PI / 180) || !polygon.covers(at)) continue;
      ++rays;
      spacing += step * (at - scanner).norm() / std::sqrt(cosine);
    }
    auto& one = score.openings[k];
    if (rays == 0) continue;
    // The scan that sees it best says how far apart samples are.
    const double mean = spacing / static_cast<double>(rays);
    one.spacing_m = one.rays.value_or(0) > 0 ? std::min(*one.spacing_m, mean) : mean;
    one.rays = one.rays.value_or(0) + rays;
  }
}

}  // namespace score
