#include "stages/sample_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace hybrid::stages {
namespace {

constexpr double kLongestStretch = 4;  // of the sample spacing, at grazing incidence or beside a gap
// A neighbour of the same surface, in sample spacings: difference in range, distance from the tangent plane.
constexpr double kSteepestJump = 10;
constexpr double kOffTangent = 1;
constexpr int kWindow = 2;                 // neighbours on either side that tell the normal
constexpr double kDefaultStep_rad = 1e-3;  // of an image of one sample, which has no spacing of its own

std::optional<std::size_t> node(const RangeImage& image, int row, int col) {
  if (image.wraps && image.cols > 0) col = (col + image.cols) % image.cols;
  if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return std::nullopt;
  const std::size_t i = image.index(row, col);
  if (image.mask[i] == kEmpty) return std::nullopt;
  return i;
}

// Least squares plane through the neighbours that lie on the same surface: range noise turns the normal of
// two neighbours by noise over spacing, that of the window by a tenth of it.
Vec3 neighbour_normal(const RangeImage& image, int row, int col, double spacing_m) {
  const Vec3 centre = image.point(image.index(row, col));
  const double range = centre.norm();
  Vec3 sum = Vec3::Zero();
  Mat3 products = Mat3::Zero();
  int count = 0;
  for (int dr = -kWindow; dr <= kWindow; ++dr)
    for (int dc = -kWindow; dc <= kWindow; ++dc) {
      const auto i = node(image, row + dr, col + dc);
      if (!i) continue;
      const Vec3 arm = image.point(*i) - centre;
      const double apart = spacing_m * std::max(std::abs(dr), std::abs(dc));
      if (std::abs(image.point(*i).norm() - range) > kSteepestJump * apart) continue;
      sum += arm;
      products += arm * arm.transpose();
      ++count;
    }
  if (count < 3) return Vec3::Zero();
  const Mat3 scatter = products - sum * sum.transpose() / count;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(scatter);
  const Vec3 spread = solver.eigenvalues();
  if (!(spread[1] > 1e-3 * spread[2])) return Vec3::Zero();  // on a line
  return solver.eigenvectors().col(0);
}

// Distance to the farther of the two neighbours along the rows or the columns, of those that lie on the same
// surface, in the sample's tangent plane: patches close up. At a silhouette only the inner one does, so that
// the patch hardly reaches beyond it. Where a return is missing the next sample counts: only measured ones
// become patches. Half the nominal spacing where there is none, as in a veil or across a wire.
double neighbour_spacing(const RangeImage& image, int row, int col, int down, int across, double nominal_m,
                         const Vec3& normal) {
  const Vec3 centre = image.point(image.index(row, col));
  double spacing = 0;
  for (const int side : {-1, 1})
    for (const int steps : {side, 2 * side}) {
      const auto i = node(image, row + steps * down, col + steps * across);
      if (!i || image.mask[*i] != kMeasured) continue;
      const Vec3 arm = image.point(*i) - centre;
      const double jump = std::abs(image.point(*i).norm() - centre.norm());
      const double reach_m = std::abs(steps) * nominal_m;
      if (jump <= kSteepestJump * reach_m && std::abs(normal.dot(arm)) <= kOffTangent * reach_m)
        spacing = std::max(spacing, arm.norm());
      break;
    }
  return spacing > 0 ? std::min(spacing, kLongestStretch * nominal_m) : 0.5 * nominal_m;
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
  if (label > 0) {
    // The patch is as long as the tilt makes it in one direction only.
    const double stretch = std::min(1 / std::max(std::abs(facing), 1e-9), kLongestStretch);
    surface.radius_m = 0.5 * std::max(down_m, across_m) * std::hypot(stretch, 1.0);
  } else {
    surface.radius_m = 0.5 * std::hypot(neighbour_spacing(image, row, col, 1, 0, down_m, surface.normal),
                                        neighbour_spacing(image, row, col, 0, 1, across_m, surface.normal));
  }
  return surface;
}

}  // namespace hybrid::stages
