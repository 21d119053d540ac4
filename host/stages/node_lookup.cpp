#include "stages/node_lookup.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid::stages {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

NodeLookup::Axis::Axis(const std::vector<double>& angles)
    : angles_(angles),
      low_(std::min(angles.front(), angles.back())),
      high_(std::max(angles.front(), angles.back())),
      step_(angles.size() > 1 ? (high_ - low_) / static_cast<double>(angles.size() - 1) : 0),
      sign_(angles.front() <= angles.back() ? 1 : -1) {}

int NodeLookup::Axis::nearest(double angle) const {
  if (!(step_ > 0)) return 0;
  const int last = static_cast<int>(angles_.size()) - 1;
  const double from_first = sign_ * (angle - angles_.front()) / step_;
  // From where even steps would have it on to where it is.
  int k = static_cast<int>(std::lround(std::clamp(from_first, 0.0, static_cast<double>(last))));
  const auto off = [&](int i) { return std::abs(angles_[static_cast<std::size_t>(i)] - angle); };
  while (k < last && off(k + 1) < off(k)) ++k;
  while (k > 0 && off(k - 1) < off(k)) --k;
  return k;
}

NodeLookup::NodeLookup(const RangeImage& image)
    : wraps_(image.wraps), rows_(image.elevation_rad), cols_(image.azimuth_rad) {}

NodeLookup::Node NodeLookup::towards(const Vec3& point) const {
  const double elevation = std::atan2(point.z(), std::sqrt(point.x() * point.x() + point.y() * point.y()));
  // In the turn that begins half a step before the first column.
  const double begin = cols_.low() - cols_.step() / 2;
  double azimuth = std::atan2(point.y(), point.x());
  while (azimuth < begin) azimuth += kTurn;
  while (azimuth >= begin + kTurn) azimuth -= kTurn;
  const double past = azimuth - cols_.high();
  return {
      rows_.nearest(elevation), cols_.nearest(azimuth),
      elevation >= rows_.low() - rows_.step() && elevation <= rows_.high() + rows_.step() &&
          (wraps_ || past <= cols_.step() || past >= kTurn - cols_.step() - (cols_.high() - cols_.low()))};
}

}  // namespace hybrid::stages
