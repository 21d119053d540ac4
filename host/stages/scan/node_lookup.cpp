#include "stages/scan/node_lookup.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr int kMostSteps = 8;  // of a walk

}  // namespace

NodeLookup::Axis::Axis(const std::vector<double>& angles)
    : angles_(angles),
      low_(angles.empty() ? 0 : std::min(angles.front(), angles.back())),
      high_(angles.empty() ? 0 : std::max(angles.front(), angles.back())),
      step_(angles.size() > 1 ? (high_ - low_) / static_cast<double>(angles.size() - 1) : 0),
      sign_(angles.empty() || angles.front() <= angles.back() ? 1 : -1) {}

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

std::vector<double> NodeLookup::Axis::middles() const {
  std::vector<double> middles;
  for (std::size_t i = 0; i + 1 < angles_.size(); ++i) middles.push_back((angles_[i] + angles_[i + 1]) / 2);
  return middles;
}

NodeLookup::NodeLookup(const RangeImage& image)
    : wraps_(image.wraps), rows_(image.elevation_rad), cols_(image.azimuth_rad) {
  if (!(rows_.low() > -kTurn / 4) || !(rows_.high() < kTurn / 4)) return;
  for (const double angle : rows_.middles()) row_ends_.push_back(std::tan(angle));
  for (const double angle : cols_.middles()) col_ends_.push_back({std::cos(angle), std::sin(angle)});
}

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

NodeLookup::Node NodeWalk::towards(const Vec3& point) {
  if (!walk(point)) last_ = lookup_.towards(point);
  return last_;
}

// False where it does not arrive at a node inside the image.
bool NodeWalk::walk(const Vec3& point) {
  const auto& row_ends = lookup_.row_ends_;
  const auto& col_ends = lookup_.col_ends_;
  const auto rows = static_cast<int>(row_ends.size()), cols = static_cast<int>(col_ends.size());
  auto [row, col, within] = last_;
  if (!within || row < 1 || row >= rows || col < 1 || col >= cols) return false;
  const double x = point.x(), y = point.y(), flat = std::sqrt(x * x + y * y);
  const double up = lookup_.rows_.sign(), around = lookup_.cols_.sign();
  int steps = 0;
  // Beyond the end between a row, or column, and the next?
  const auto past_row = [&](int k) {
    return up * (point.z() - flat * row_ends[static_cast<std::size_t>(k)]) > 0;
  };
  const auto past_col = [&](int k) {
    const Vec2& end = col_ends[static_cast<std::size_t>(k)];
    return around * (end.x() * y - end.y() * x) > 0;
  };
  while (row < rows && past_row(row) && ++steps <= kMostSteps) ++row;
  while (row > 0 && !past_row(row - 1) && ++steps <= kMostSteps) --row;
  while (col < cols && past_col(col) && ++steps <= kMostSteps) ++col;
  while (col > 0 && !past_col(col - 1) && ++steps <= kMostSteps) --col;
  if (steps > kMostSteps || row < 1 || row >= rows || col < 1 || col >= cols) return false;
  const Vec2& ahead = col_ends[static_cast<std::size_t>(col)];
  if (!(ahead.x() * x + ahead.y() * y > 0)) return false;  // behind the scanner every side is the other one
  last_ = {row, col, true};
  return true;
}

}  // namespace hybrid::stages
