#include "stages/planes/rim_crossings.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

// Two neighbours are a surface when they lie about as far behind the plane they are seen from: within this,
// or this share of it.
constexpr double kLevel_m = 0.01, kLevelShare = 0.15;

}  // namespace

double RimCrossing::jump_m() const {
  if (is_crease()) return 0;
  return std::abs(behind_here_m) < std::abs(behind_there_m) ? behind_here_m : behind_there_m;
}

std::optional<double> RimCrossings::behind_m(const Plane& plane, std::size_t i) const {
  const Vec3 point = image_.point(i);
  const double along = plane.normal.dot(point);
  if (!(along * plane.offset_m > 0)) return std::nullopt;
  return point.norm() * (1 - plane.offset_m / along);
}

double RimCrossings::cosine(std::size_t i) const {
  const Vec3 point = image_.point(i);
  return std::abs(plane(i).normal.dot(point)) / point.norm();
}

double RimCrossings::spacing_m(std::size_t i, int col_step) const {
  const Vec3 point = image_.point(i);
  return col_step == 0 ? image_.elevation_step_rad() * point.norm()
                       : image_.azimuth_step_rad() * std::hypot(point.x(), point.y());
}

std::optional<RimCrossing> RimCrossings::cross(int row, int col, int row_step, int col_step) const {
  const std::size_t i = image_.index(row, col);
  for (int k = 1; k <= kMostGap + 1; ++k) {
    const auto j = node(row + k * row_step, col + k * col_step);
    if (!j || labels_[*j] == labels_[i]) return std::nullopt;
    if (image_.mask[*j] != kMeasured) continue;
    const auto here = behind_m(plane(i), *j);
    if (!here) continue;
    if (on_plane(*j)) {
      const auto back = behind_m(plane(*j), i);
      if (!back) return std::nullopt;
      return RimCrossing{k - 1, *j, true, *here, -*back};
    }
    const auto next = node(row + (k + 1) * row_step, col + (k + 1) * col_step);
    if (!next || image_.mask[*next] != kMeasured) continue;
    const auto next_here = behind_m(plane(i), *next);
    if (!next_here || std::abs(*next_here - *here) > std::max(kLevel_m, kLevelShare * std::abs(*here)))
      continue;
    const double range = image_.point(*j).norm(), slope = image_.point(*next).norm() - range;
    return RimCrossing{k - 1, *j, false, *here, range - slope * k - image_.point(i).norm()};
  }
  return std::nullopt;
}

}  // namespace hybrid::stages
