#include "stages/rendering/scan_sight.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBeside = 3;  // times the tolerance
constexpr int kSkyMargin = 2;  // nodes around one that looks at the sky that do so, too

}  // namespace

ScanSight::ScanSight(const std::vector<SightScan>& scans, double tolerance_m)
    : scans_(scans), tolerance_m_(tolerance_m) {
  for (const SightScan& scan : scans) {
    lookups_.emplace_back(*scan.image);
    scan_from_world_.push_back(scan.world_from_scan.inverse());
    skies_.push_back(sky_of(*scan.image));
  }
}

ScanSight::Sky ScanSight::sky_of(const RangeImage& image) {
  Sky sky;
  if (!image.wraps || image.count() == 0) return sky;
  sky.rows.assign(static_cast<std::size_t>(image.cols), image.rows);
  std::vector<float> farthest(static_cast<std::size_t>(image.rows), 0.0F);
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t row) {
    for (int col = 0; col < image.cols; ++col)
      if (const std::size_t i = image.index(static_cast<int>(row), col); image.mask[i] == kMeasured)
        farthest[row] = std::max(farthest[row], image.range_m[i]);
  });
  sky.farthest_m = *std::max_element(farthest.begin(), farthest.end());
  for (int col = 0; col < image.cols; ++col) {
    int row = 0;
    while (row < image.rows && image.mask[image.index(row, col)] == kEmpty) ++row;
    sky.rows[static_cast<std::size_t>(col)] = row;
  }
  return sky;
}

bool ScanSight::is_empty(const Vec3& place, std::size_t but) const {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (s == but || scans_[s].image->count() == 0) continue;
    const Vec3 point = scan_from_world_[s] * place;
    const auto node = lookups_[s].towards(point);
    if (!node.within) continue;
    if (const auto range = sight_m(s, node.row, node.col); range && *range > point.norm() + tolerance_m_)
      return true;
  }
  return false;
}

bool ScanSight::is_seen_through(const Vec3& place, double margin_m, double spacing_m, std::size_t but) const {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (s == but || scans_[s].image->count() == 0) continue;
    const Vec3 point = scan_from_world_[s] * place;
    if (point.norm() * scans_[s].image->step_rad() > spacing_m) continue;
    const double least_m = point.norm() + margin_m;
    const Vec3 side = margin_m * point.unitOrthogonal();
    const Vec3 up = point.normalized().cross(side);
    bool through = true;
    for (const auto& [x, y] :
         {std::pair{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
      const auto beside = lookups_[s].towards(point + x * side + y * up);
      const auto range = beside.within ? sight_m(s, beside.row, beside.col) : std::nullopt;
      through = range && *range > least_m;
      if (!through) break;
    }
    if (through) return true;
  }
  return false;
}

std::optional<FinerSamples> ScanSight::seen_finer(const Vec3& place, std::size_t scan, double times,
                                                  double past_m) const {
  double own_step_m = 0, own_m = 0;     // once there is another
  std::optional<FinerSamples> closest;  // at its edge
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (s == scan || scans_[s].image->count() == 0) continue;
    if (own_m == 0) {
      const Vec3 own = scan_from_world_[scan] * place;
      own_step_m = own.norm() * scans_[scan].image->step_rad();
      const auto at = lookups_[scan].towards(own);
      own_m = spacing_m(scan, at.row, at.col).value_or(own_step_m);
    }
    const Vec3 point = scan_from_world_[s] * place;
    const double step_m = point.norm() * scans_[s].image->step_rad();
    if (times * step_m > own_m) continue;
    const auto node = lookups_[s].towards(point);
    if (!node.within) continue;
    const auto range = sight_m(s, node.row, node.col);
    if (!range) continue;
    const bool past = *range > point.norm() + past_m;
    if (!past && std::abs(*range - point.norm()) > tolerance_m_) continue;
    const double world_m = step_m * scans_[s].world_from_scan.scale;
    if (const auto spacing = past ? std::nullopt : spacing_m(s, node.row, node.col);
        spacing && times * *spacing <= own_m)
      return FinerSamples{false, world_m};
    // There a sample's spacing is that to what is behind the edge.
    if (times * step_m <= own_step_m && !(closest && closest->spacing_m <= world_m))
      closest = FinerSamples{true, world_m};
  }
  return closest;
}

bool ScanSight::is_hidden(const Vec3& place, std::size_t scan) const {
  if (scans_[scan].image->count() == 0) return false;
  const Vec3 point = scan_from_world_[scan] * place;
  const auto node = lookups_[scan].towards(point);
  if (!node.within) return false;
  const auto range = range_m(scan, node.row, node.col);
  return range && *range < point.norm() - tolerance_m_;
}

template <typename Towards>
ScanSight::Known ScanSight::known(const Vec3& place, const Towards& towards) const {
  Known known = Known::no;
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (scans_[s].image->count() == 0) continue;
    const Vec3 point = scan_from_world_[s] * place;
    const NodeLookup::Node node = towards(s, point);
    if (!node.within) continue;
    const double there_m = point.norm();
    if (const auto range = sight_m(s, node.row, node.col)) {
      if (*range > there_m + tolerance_m_) return Known::empty;
      if (*range > there_m - tolerance_m_) known = Known::yes;
    } else if (known == Known::no && is_beside(s, node, there_m)) {
      known = Known::yes;
    }
  }
  return known;
}

ScanSight::Known ScanSight::known(const Vec3& place) const {
  return known(place, [&](std::size_t s, const Vec3& point) { return lookups_[s].towards(point); });
}

SightWalk::SightWalk(const ScanSight& sight)
    : sight_(sight), walks_(sight.lookups_.begin(), sight.lookups_.end()) {}

ScanSight::Known SightWalk::known(const Vec3& place) {
  return sight_.known(place, [&](std::size_t s, const Vec3& point) { return walks_[s].towards(point); });
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
  const double ball = point.norm() > radius_m ? std::asin(radius_m / point.norm()) : kTurn / 2;
  const double elevation = std::atan2(point.z(), point.head<2>().norm());
  const double azimuth = std::atan2(point.y(), point.x());
  const double reach = ball + 2 * image.step_rad(), steepest = std::abs(elevation) + reach;
  const double turn = steepest < kTurn / 4 ? reach / std::cos(steepest) : kTurn / 2;
  std::vector<int> rows, cols;
  for (int row = 0; row < image.rows; ++row)
    if (std::abs(image.elevation_rad[static_cast<std::size_t>(row)] - elevation) <= reach)
      rows.push_back(row);
  for (int col = 0; col < image.cols; ++col)
    if (std::abs(std::remainder(image.azimuth_rad[static_cast<std::size_t>(col)] - azimuth, kTurn)) <= turn)
      cols.push_back(col);
  const double count = static_cast<double>(rows.size()) * static_cast<double>(cols.size());
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::sqrt(count / many)));
  std::vector<Vec3> found;
  for (std::size_t r = 0; r < rows.size(); r += stride)
    for (std::size_t c = 0; c < cols.size(); c += stride) {
      if (!range_m(scan, rows[r], cols[c])) continue;
      const Vec3 sample = image.point(image.index(rows[r], cols[c]));
      if ((sample - point).norm() <= radius_m) found.push_back(sample);
    }
  return found;
}

bool ScanSight::is_beside(std::size_t scan, const NodeLookup::Node& node, double there_m) const {
  for (int k = 0; k < 9; ++k)
    if (const auto range = range_m(scan, node.row + k / 3 - 1, node.col + k % 3 - 1);
        range && std::abs(*range - there_m) <= kBeside * tolerance_m_)
      return true;
  return false;
}

// Of a sample and its four neighbours, the larger of both directions; nothing where one of them is missing.
std::optional<double> ScanSight::spacing_m(std::size_t scan, int row, int col) const {
  const RangeImage& image = *scans_[scan].image;
  double spacing = 0;
  for (const auto& [down, across] : {std::pair{1, 0}, {0, 1}}) {
    if (!range_m(scan, row - down, col - across) || !range_m(scan, row + down, col + across)) return {};
    const Vec3 before = image.point(image.index(row - down, image.wrapped(col - across)));
    const Vec3 after = image.point(image.index(row + down, image.wrapped(col + across)));
    spacing = std::max(spacing, (after - before).norm() / 2);
  }
  return spacing;
}

std::optional<double> ScanSight::range_m(std::size_t scan, int row, int col) const {
  const RangeImage& image = *scans_[scan].image;
  col = image.wrapped(col);
  if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return std::nullopt;
  const std::size_t i = image.index(row, col);
  const auto* stray = scans_[scan].stray;
  if (image.mask[i] != kMeasured || (stray && !stray->empty() && (*stray)[i])) return std::nullopt;
  return image.range_m[i];
}

std::optional<double> ScanSight::sight_m(std::size_t scan, int row, int col) const {
  if (const auto range = range_m(scan, row, col)) return range;
  const RangeImage& image = *scans_[scan].image;
  const Sky& sky = skies_[scan];
  if (sky.rows.empty() || row < 0 || row >= image.rows) return std::nullopt;
  const int least = std::min(row + kSkyMargin + 1, image.rows);
  for (int c = col - kSkyMargin; c <= col + kSkyMargin; ++c)
    if (sky.rows[static_cast<std::size_t>(image.wrapped(c))] < least) return std::nullopt;
  return sky.farthest_m;
}

}  // namespace hybrid::stages
