#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"

namespace hybrid::testing {

// A box room 8 x 6 x 3.3 m with a pillar of 0.6 x 0.6 m, seen from a scanner inside it: enough to know every
// range and normal.
struct Room {
  Vec3 low{-4, -3, -1.5}, high{4, 3, 1.8};
  Vec3 pillar_low{1.5, 0.5, -1.5}, pillar_high{2.1, 1.1, 1.8};

  struct Hit {
    double range_m;
    Vec3 normal;  // towards the scanner
  };
  Hit cast(const Vec3& ray) const {
    Hit hit{INFINITY, Vec3::Zero()};
    for (int axis = 0; axis < 3; ++axis) {
      const double wall = (ray[axis] > 0 ? high[axis] : low[axis]) / ray[axis];
      if (ray[axis] != 0 && wall < hit.range_m)
        hit = {wall, -std::copysign(1.0, ray[axis]) * Vec3::Unit(axis)};
    }
    double enter = 0, leave = INFINITY;
    int side = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = pillar_low[axis] / ray[axis], b = pillar_high[axis] / ray[axis];
      if (std::min(a, b) > enter) {
        enter = std::min(a, b);
        side = axis;
      }
      leave = std::min(leave, std::max(a, b));
    }
    if (side >= 0 && enter < leave && enter < hit.range_m)
      hit = {enter, -std::copysign(1.0, ray[side]) * Vec3::Unit(side)};
    return hit;
  }
};

inline Vec3 direction(double elevation, double azimuth) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

struct RoomScanOptions {
  int columns = 240;
  double first_azimuth_rad = -3.1, turn_rad = 2 * std::numbers::pi;
  double step_rad = 0.02, lowest_rad = -1.0, highest_rad = 1.5;
  double noise_m = 0.002, dropouts = 0.02;
  double start_steps = 2.5, jitter_steps = 0.04;  // a column starts anywhere in this many steps
  unsigned seed = 1;
};

// Columns swept upwards, returns only, in the order of acquisition.
inline Scan scan_room(const RoomScanOptions& options = {}, const Room& room = {}) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Scan scan;
  scan.name = "room";
  for (int c = 0; c < options.columns; ++c) {
    const double azimuth = options.first_azimuth_rad + options.turn_rad * c / options.columns;
    const double start = options.lowest_rad + options.step_rad * options.start_steps * uniform(random);
    for (int k = 0;; ++k) {
      const double jitter = std::clamp(options.jitter_steps * normal(random), -0.2, 0.2);
      const double elevation = start + options.step_rad * (k + jitter);
      const double noise = options.noise_m * normal(random);
      const bool dropped = uniform(random) < options.dropouts;
      if (elevation > options.highest_rad) break;
      if (dropped) continue;
      const Vec3 ray = direction(elevation, azimuth);
      const Vec3f point = ((room.cast(ray).range_m + noise) * ray).cast<float>();
      scan.points.push_back({point.x(), point.y(), point.z()});
      scan.intensity.push_back(static_cast<float>(scan.points.size()));
    }
  }
  return scan;
}

// The room straight on a grid, for the stages after resampling.
inline RangeImage image_room(int rows, int cols, double step_rad, double noise_m, const Room& room = {}) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  RangeImage image = make_range_image(rows, cols);
  for (int row = 0; row < rows; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = step_rad * (0.5 * rows - row);
  for (int col = 0; col < cols; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = -3 + step_rad * col;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const Vec3 ray = direction(image.elevation_rad[static_cast<std::size_t>(row)],
                                 image.azimuth_rad[static_cast<std::size_t>(col)]);
      const double range = room.cast(ray).range_m + noise_m * normal(random);
      const std::size_t i = image.index(row, col);
      image.range_m[i] = static_cast<float>(range);
      image.x[i] = static_cast<float>(range * ray.x());
      image.y[i] = static_cast<float>(range * ray.y());
      image.z[i] = static_cast<float>(range * ray.z());
      image.mask[i] = kMeasured;
      image.source[i] = static_cast<std::uint32_t>(i);
    }
  return image;
}

inline void make_empty(RangeImage& image, int row, int col) {
  const std::size_t i = image.index(row, col);
  image.range_m[i] = image.x[i] = image.y[i] = image.z[i] = std::numeric_limits<float>::quiet_NaN();
  image.mask[i] = kEmpty;
  image.source[i] = kNoSource;
}

}  // namespace hybrid::testing
