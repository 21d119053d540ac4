#include "stages/rendering/column_backs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSlice_m = 0.1;
constexpr double kBeside = 3;  // times the tolerance
constexpr double kTurn = 2 * std::numbers::pi / kColumnSides;

// Whether any of the scans has a sample at the place or behind it; where a scan has none in that direction,
// whether the surface is there beside it.
class Sight {
 public:
  Sight(const std::vector<CurtainScan>& scans, double tolerance_m)
      : scans_(scans), tolerance_m_(tolerance_m) {
    for (const CurtainScan& scan : scans) {
      lookups_.emplace_back(*scan.image);
      scan_from_world_.push_back(scan.world_from_scan.inverse());
    }
  }

  bool knows(const Vec3& place) const {
    for (std::size_t s = 0; s < scans_.size(); ++s)
      if (scans_[s].image->count() > 0 && reaches(s, scan_from_world_[s] * place)) return true;
    return false;
  }

 private:
  bool reaches(std::size_t s, const Vec3& point) const {
    const auto node = lookups_[s].towards(point);
    if (!node.within) return false;
    const double least_m = point.norm() - tolerance_m_;
    if (const auto range = range_m(scans_[s], node.row, node.col)) return *range > least_m;
    for (int k = 0; k < 9; ++k)
      if (const auto range = range_m(scans_[s], node.row + k / 3 - 1, node.col + k % 3 - 1);
          range && std::abs(*range - point.norm()) <= kBeside * tolerance_m_)
        return true;
    return false;
  }

  static std::optional<double> range_m(const CurtainScan& scan, int row, int col) {
    const RangeImage& image = *scan.image;
    if (image.wraps) col = (col + image.cols) % image.cols;
    if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return std::nullopt;
    const std::size_t i = image.index(row, col);
    const bool is_stray = scan.stray && !scan.stray->empty() && (*scan.stray)[i];
    if (image.mask[i] != kMeasured || is_stray) return std::nullopt;
    return image.point(i).norm();
  }

  const std::vector<CurtainScan>& scans_;
  double tolerance_m_;
  std::vector<NodeLookup> lookups_;
  std::vector<Pose> scan_from_world_;
};

void append_backs(const Sight& sight, const CurtainScan& scan, std::size_t index, const Cylinder& cylinder,
                  std::vector<ColumnBack>& backs) {
  const Pose& world = scan.world_from_scan;
  const int slices = std::max(1, static_cast<int>(std::lround(cylinder.length_m / kSlice_m)));
  const auto at = [&](double slice, double side) {
    return Vec3(world * on_cylinder(cylinder, cylinder.length_m * slice / slices, kTurn * side));
  };
  for (int side = 0; side < kColumnSides; ++side) {
    int first = 0;
    for (int slice = 0; slice <= slices; ++slice) {
      if (slice < slices && !sight.knows(at(slice + 0.5, side + 0.5))) continue;
      if (slice > first)
        backs.push_back({index,
                         cylinder.id,
                         {at(first, side), at(first, side + 1), at(slice, side + 1), at(slice, side)}});
      first = slice + 1;
    }
  }
}

}  // namespace

Vec3 on_cylinder(const Cylinder& cylinder, double along_m, double turn_rad, double off_m) {
  const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
  const double radius = cylinder.radius_at(std::clamp(along_m, 0.0, cylinder.length_m)) + off_m;
  return cylinder.foot + along_m * cylinder.axis + radius * (std::cos(turn_rad) * a + std::sin(turn_rad) * b);
}

std::vector<ColumnBack> column_backs(const std::vector<CurtainScan>& scans, double tolerance_m) {
  std::vector<ColumnBack> backs;
  const auto shows_one = [](const Cylinder& cylinder) { return !cylinder.inside; };
  if (std::none_of(scans.begin(), scans.end(), [&](const CurtainScan& scan) {
        return scan.cylinders && std::any_of(scan.cylinders->begin(), scan.cylinders->end(), shows_one);
      }))
    return backs;
  const Sight sight(scans, tolerance_m);
  for (std::size_t s = 0; s < scans.size(); ++s)
    if (scans[s].cylinders)
      for (const Cylinder& cylinder : *scans[s].cylinders)
        if (shows_one(cylinder)) append_backs(sight, scans[s], s, cylinder, backs);
  return backs;
}

}  // namespace hybrid::stages
