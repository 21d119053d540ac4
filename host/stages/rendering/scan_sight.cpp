#include "stages/rendering/scan_sight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid::stages {
namespace {

constexpr double kBeside = 3;  // times the tolerance

}  // namespace

ScanSight::ScanSight(const std::vector<SightScan>& scans, double tolerance_m)
    : scans_(scans), tolerance_m_(tolerance_m) {
  for (const SightScan& scan : scans) {
    lookups_.emplace_back(*scan.image);
    scan_from_world_.push_back(scan.world_from_scan.inverse());
  }
}

bool ScanSight::is_empty(const Vec3& place, std::size_t but) const {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (s == but || scans_[s].image->count() == 0) continue;
    const Vec3 point = scan_from_world_[s] * place;
    const auto node = lookups_[s].towards(point);
    if (!node.within) continue;
    if (const auto range = range_m(s, node.row, node.col); range && *range > point.norm() + tolerance_m_)
      return true;
  }
  return false;
}

bool ScanSight::is_known(const Vec3& place) const {
  for (std::size_t s = 0; s < scans_.size(); ++s)
    if (scans_[s].image->count() > 0 && reaches(s, scan_from_world_[s] * place)) return true;
  return false;
}

std::vector<SightColumn> ScanSight::columns() const {
  std::vector<SightColumn> found;
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (scans_[s].cylinders == nullptr) continue;
    for (const Cylinder& cylinder : *scans_[s].cylinders) {
      if (cylinder.inside) continue;
      found.push_back({s, cylinder});
      found.back().cylinder.foot = scans_[s].world_from_scan * cylinder.foot;
      found.back().cylinder.axis = scans_[s].world_from_scan.rotation * cylinder.axis;
    }
  }
  return found;
}

std::vector<Vec3> ScanSight::samples_near(const Vec3& place, double radius_m, double many) const {
  std::vector<Vec3> all;
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (scans_[s].image->count() == 0) continue;
    for (const Vec3& point : samples_near(s, scan_from_world_[s] * place, radius_m, many))
      all.push_back(scans_[s].world_from_scan * point);
  }
  return all;
}

std::vector<Vec3> ScanSight::samples_near(std::size_t scan, const Vec3& point, double radius_m,
                                          double many) const {
  const RangeImage& image = *scans_[scan].image;
  // Rows and columns that may see the ball.
  const double angle = point.norm() > radius_m ? std::asin(radius_m / point.norm()) : std::numbers::pi;
  const double steepest = std::abs(std::atan2(point.z(), point.head<2>().norm())) + angle;
  const double turn = steepest < std::numbers::pi / 2 ? std::min(angle / std::cos(steepest), std::numbers::pi)
                                                      : std::numbers::pi;
  const auto nodes = [](double reach, double step, int all) {
    return static_cast<int>(std::min(reach / std::max(std::abs(step), 1e-9) + 2, 1.0 * all));
  };
  const auto [row, col, within] = lookups_[scan].towards(point);
  const int up = nodes(angle, image.elevation_step_rad(), image.rows);
  const int aside = nodes(turn, image.azimuth_step_rad(), image.cols);
  const int top = std::max(row - up, 0), bottom = std::min(row + up + 1, image.rows);
  int left = col - aside, right = col + aside + 1;
  if (!image.wraps || right - left >= image.cols) {
    left = image.wraps ? 0 : std::max(left, 0);
    right = image.wraps ? image.cols : std::min(right, image.cols);
  }
  const double count = static_cast<double>(bottom - top) * (right - left);
  const int stride = std::max(1, static_cast<int>(std::sqrt(count / many)));
  std::vector<Vec3> found;
  for (int r = top; r < bottom; r += stride)
    for (int c = left; c < right; c += stride) {
      if (!range_m(scan, r, c)) continue;
      const Vec3 sample = image.point(image.index(r, (c + image.cols) % image.cols));
      if ((sample - point).norm() <= radius_m) found.push_back(sample);
    }
  return found;
}

bool ScanSight::reaches(std::size_t scan, const Vec3& point) const {
  const auto node = lookups_[scan].towards(point);
  if (!node.within) return false;
  const double least_m = point.norm() - tolerance_m_;
  if (const auto range = range_m(scan, node.row, node.col)) return *range > least_m;
  for (int k = 0; k < 9; ++k)
    if (const auto range = range_m(scan, node.row + k / 3 - 1, node.col + k % 3 - 1);
        range && std::abs(*range - point.norm()) <= kBeside * tolerance_m_)
      return true;
  return false;
}

std::optional<double> ScanSight::range_m(std::size_t scan, int row, int col) const {
  const RangeImage& image = *scans_[scan].image;
  if (image.wraps) col = (col + image.cols) % image.cols;
  if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return std::nullopt;
  const std::size_t i = image.index(row, col);
  const auto* stray = scans_[scan].stray;
  if (image.mask[i] != kMeasured || (stray && !stray->empty() && (*stray)[i])) return std::nullopt;
  return image.point(i).norm();
}

}  // namespace hybrid::stages
