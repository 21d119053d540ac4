#include "stages/sample_surface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hybrid::stages {
namespace {

constexpr double kLongestStretch = 3;  // of a sample's patch at grazing incidence
constexpr double kSteepestJump =
    10;  // range difference to a neighbour of the same surface, in sample spacings
constexpr double kDefaultStep_rad = 1e-3;  // of an image of one sample, which has no spacing of its own

std::optional<std::size_t> node(const RangeImage& image, int row, int col) {
  if (image.wraps && image.cols > 0) col = (col + image.cols) % image.cols;
  if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return std::nullopt;
  const std::size_t i = image.index(row, col);
  if (image.mask[i] == kEmpty) return std::nullopt;
  return i;
}

// The neighbour in direction +-(row_step, col_step) that lies nearest in range, as an arm pointing along
// +(row_step, col_step); nothing when both are farther than `reach_m`.
std::optional<Vec3> arm(const RangeImage& image, int row, int col, int row_step, int col_step,
                        double reach_m) {
  const Vec3 centre = image.point(image.index(row, col));
  const double range = centre.norm();
  std::optional<Vec3> best;
  double nearest = reach_m;
  for (int sign : {1, -1})
    if (const auto i = node(image, row + sign * row_step, col + sign * col_step)) {
      const Vec3 point = image.point(*i);
      const double jump = std::abs(point.norm() - range);
      if (jump < nearest) {
        nearest = jump;
        best = sign * (point - centre);
      }
    }
  return best;
}

Vec3 neighbour_normal(const RangeImage& image, int row, int col, double spacing_m) {
  const auto across = arm(image, row, col, 0, 1, kSteepestJump * spacing_m);
  const auto down = arm(image, row, col, 1, 0, kSteepestJump * spacing_m);
  if (!across || !down) return Vec3::Zero();
  const Vec3 normal = across->cross(*down);
  const double length = normal.norm();
  return length > 1e-3 * across->norm() * down->norm() && length > 0 ? Vec3(normal / length) : Vec3::Zero();
}

}  // namespace

SampleSurface sample_surface(const RangeImage& image, const PlaneSegmentation& segmentation, int row,
                             int col) {
  const std::size_t i = image.index(row, col);
  const Vec3 point = image.point(i);
  const double range = point.norm();
  SampleSurface surface;
  if (!(range > 0)) return surface;
  double down_m = range * image.elevation_step_rad();
  double across_m = range * image.azimuth_step_rad() * point.head<2>().norm() / range;
  if (std::max(down_m, across_m) <= 0) down_m = across_m = range * kDefaultStep_rad;

  const std::uint32_t label = i < segmentation.sample_label.size() ? segmentation.sample_label[i] : 0;
  surface.normal = label > 0 && label <= segmentation.superclusters.size()
                       ? segmentation.superclusters[label - 1].plane.normal
                       : neighbour_normal(image, row, col, std::max(down_m, across_m));
  const double facing = -surface.normal.dot(point) / range;
  if (facing < 0) surface.normal = -surface.normal;
  const bool known = surface.normal != Vec3::Zero();
  const double stretch = known ? std::min(1 / std::max(std::abs(facing), 1e-9), kLongestStretch) : 1;
  surface.radius_m = 0.5 * std::hypot(down_m, across_m) * stretch;
  return surface;
}

}  // namespace hybrid::stages
