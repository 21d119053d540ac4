#include "stages/scan/sample_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace hybrid::stages {
namespace {

constexpr double kLongestStretch = 4;  // of the sample spacing, at grazing incidence or beside a gap
// A neighbour of the same surface, in sample spacings: difference in range, distance from the tangent plane.
constexpr double kSteepestJump = 10;
constexpr double kOffTangent = 1;
constexpr double kSteepest = 7;            // the first, of those that tell the normal, where they suffice
constexpr double kUneven = 1.5;            // times as far as the neighbour on the other side: across an edge
constexpr int kWindow = 2;                 // neighbours on either side that tell the normal
constexpr double kDefaultStep_rad = 1e-3;  // of an image of one sample, which has no spacing of its own

// Sums of a plane through points, about one of them.
struct ArmSums {
  double x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  int count = 0;

  void add(double ax, double ay, double az) {
    x += ax, y += ay, z += az;
    xx += ax * ax, xy += ax * ay, xz += ax * az, yy += ay * ay, yz += ay * az, zz += az * az;
    ++count;
  }

  // Zero where they lie on a line.
  Vec3 normal() const {
    if (count < 3) return Vec3::Zero();
    Mat3 scatter;
    scatter << xx - x * x / count, xy - x * y / count, xz - x * z / count,  //
        xy - x * y / count, yy - y * y / count, yz - y * z / count,         //
        xz - x * z / count, yz - y * z / count, zz - z * z / count;
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(scatter);
    const Vec3 spread = solver.eigenvalues();
    if (!(spread[1] > 1e-3 * spread[2])) return Vec3::Zero();
    return solver.eigenvectors().col(0);
  }
};

}  // namespace

SampleSurfaces::SampleSurfaces(const RangeImage& image, const PlaneSegmentation& segmentation)
    : image_(image),
      segmentation_(segmentation),
      down_rad_(image.elevation_step_rad()),
      across_rad_(image.azimuth_step_rad()) {}

int SampleSurfaces::column(int col) const {
  col = image_.wrapped(col);
  return col >= 0 && col < image_.cols ? col : -1;
}

// Least squares plane through the neighbours that lie on the same surface: range noise turns the normal of
// two neighbours by noise over spacing, that of the window by a tenth of it. A surface that hardly tilts
// keeps what is behind its edge out; one that tilts more has only a row or a column left, and is asked again.
Vec3 SampleSurfaces::neighbour_normal(int row, int col, double spacing_m) const {
  std::array<int, 2 * kWindow + 1> columns;
  for (int dc = -kWindow; dc <= kWindow; ++dc)
    columns[static_cast<std::size_t>(dc + kWindow)] = column(col + dc);
  const std::size_t centre = image_.index(row, col);
  const double range = image_.range_m[centre], x = image_.x[centre], y = image_.y[centre],
               z = image_.z[centre];
  for (const double steepest : {kSteepest, kSteepestJump}) {
    ArmSums sums;
    bool down = false, across = false;
    for (int dr = std::max(-kWindow, -row); dr <= std::min(kWindow, image_.rows - 1 - row); ++dr)
      for (int dc = -kWindow; dc <= kWindow; ++dc) {
        const int at = columns[static_cast<std::size_t>(dc + kWindow)];
        if (at < 0) continue;
        const std::size_t i = image_.index(row + dr, at);
        const double apart = spacing_m * std::max(std::abs(dr), std::abs(dc));
        if (image_.mask[i] == kEmpty) continue;
        if (!(std::abs(image_.range_m[i] - range) <= steepest * apart)) continue;
        sums.add(image_.x[i] - x, image_.y[i] - y, image_.z[i] - z);
        down = down || dr != 0;
        across = across || dc != 0;
      }
    const Vec3 normal = sums.normal();
    if (steepest == kSteepestJump || (down && across && !normal.isZero())) return normal;
  }
  return Vec3::Zero();
}

// Distance to the farther of the two neighbours along the rows or the columns, of those that lie on the same
// surface, in the sample's tangent plane: patches close up. Where one is much farther than the other there is
// an edge between, up to which the farther one has its own patch. At a silhouette only the inner one counts,
// so that the patch hardly reaches beyond it. Where a return is missing the next sample tells, at half its
// distance: the node between has a patch of its own (make_splats). Half the nominal spacing where there is
// no neighbour, as in a veil or across a wire.
double SampleSurfaces::neighbour_spacing(int row, int col, int down, int across, double nominal_m,
                                         const Vec3& normal) const {
  const std::size_t centre = image_.index(row, col);
  const double range = image_.range_m[centre];
  std::array<double, 2> apart = {0, 0};  // on either side
  for (const int side : {-1, 1})
    for (const int steps : {side, 2 * side}) {
      const int at_row = row + steps * down, at_col = column(col + steps * across);
      if (at_row < 0 || at_row >= image_.rows || at_col < 0) continue;
      const std::size_t i = image_.index(at_row, at_col);
      if (image_.mask[i] != kMeasured) continue;
      const double reach_m = std::abs(steps) * nominal_m;
      const Vec3 arm = image_.point(i) - image_.point(centre);
      if (std::abs(image_.range_m[i] - range) <= kSteepestJump * reach_m &&
          std::abs(normal.dot(arm)) <= kOffTangent * reach_m)
        apart[side > 0] = arm.norm() / std::abs(steps);
      break;
    }
  const auto [near, far] = std::minmax(apart[0], apart[1]);
  if (!(far > 0)) return 0.5 * nominal_m;
  return std::min({far, near > 0 ? kUneven * near : far, kLongestStretch * nominal_m});
}

SampleSurface SampleSurfaces::at(int row, int col) const {
  const std::size_t i = image_.index(row, col);
  const Vec3 point = image_.point(i);
  const double range = point.norm();
  SampleSurface surface;
  if (!(range > 0)) return surface;
  double down_m = range * down_rad_, across_m = across_rad_ * point.head<2>().norm();
  if (std::max(down_m, across_m) <= 0) down_m = across_m = range * kDefaultStep_rad;

  const std::uint32_t label = i < segmentation_.sample_label.size() ? segmentation_.sample_label[i] : 0;
  surface.normal = label > 0 && label <= segmentation_.superclusters.size()
                       ? segmentation_.superclusters[label - 1].plane.normal
                       : neighbour_normal(row, col, std::max(down_m, across_m));
  const double facing = -surface.normal.dot(point) / range;
  if (facing < 0) surface.normal = -surface.normal;
  if (label > 0) {
    // The patch is as long as the tilt makes it in one direction only.
    const double stretch = std::min(1 / std::max(std::abs(facing), 1e-9), kLongestStretch);
    surface.radius_m = 0.5 * std::max(down_m, across_m) * std::sqrt(stretch * stretch + 1);
  } else {
    const double down = neighbour_spacing(row, col, 1, 0, down_m, surface.normal),
                 across = neighbour_spacing(row, col, 0, 1, across_m, surface.normal);
    surface.radius_m = 0.5 * std::sqrt(down * down + across * across);
  }
  return surface;
}

}  // namespace hybrid::stages
