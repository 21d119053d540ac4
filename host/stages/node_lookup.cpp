#include "stages/node_lookup.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace hybrid::stages {
namespace {

// Of ascending or descending angles the index of the nearest.
int nearest(const std::vector<double>& angles, double angle) {
  const bool ascends = angles.front() <= angles.back();
  const auto before = [&](double a, double b) { return ascends ? a < b : a > b; };
  const auto next = std::lower_bound(angles.begin(), angles.end(), angle, before);
  if (next == angles.begin()) return 0;
  if (next == angles.end()) return static_cast<int>(angles.size()) - 1;
  const bool here = std::abs(*next - angle) < std::abs(*(next - 1) - angle);
  return static_cast<int>(next - angles.begin()) - (here ? 0 : 1);
}

constexpr double kTurn = 2 * std::numbers::pi;

double elevation_of(const Vec3& point) {
  return std::atan2(point.z(), std::hypot(point.x(), point.y()));
}

// In the turn that begins half a step before the first column.
double azimuth_of(const RangeImage& image, const Vec3& point) {
  const double first = image.azimuth_rad.front() - std::abs(image.azimuth_step_rad()) / 2;
  return first + std::fmod(std::fmod(std::atan2(point.y(), point.x()) - first, kTurn) + kTurn, kTurn);
}

}  // namespace

std::array<int, 2> node_towards(const RangeImage& image, const Vec3& point) {
  return {nearest(image.elevation_rad, elevation_of(point)),
          nearest(image.azimuth_rad, azimuth_of(image, point))};
}

bool within_grid(const RangeImage& image, const Vec3& point) {
  const double elevation = elevation_of(point), up = std::abs(image.elevation_step_rad()),
               around = std::abs(image.azimuth_step_rad());
  const auto [low, high] = std::minmax(image.elevation_rad.front(), image.elevation_rad.back());
  if (elevation < low - up || elevation > high + up) return false;
  if (image.wraps) return true;
  const double past = azimuth_of(image, point) - image.azimuth_rad.back();
  return past <= around || past >= kTurn - around - (image.azimuth_rad.back() - image.azimuth_rad.front());
}

}  // namespace hybrid::stages
