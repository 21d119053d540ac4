#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "geometry/cylinder.hpp"
#include "geometry/range_image.hpp"
#include "stages/rendering/scan_sight.hpp"

namespace hybrid::testing {

inline constexpr double kSmallScanStep_rad = 0.01;

// What a scanner that looks along +y sees, 80 x 120 nodes; `range` of a direction.
inline RangeImage scan_of(const std::function<double(const Vec3&)>& range) {
  RangeImage image = make_range_image(80, 120);
  for (int row = 0; row < 80; ++row)
    image.elevation_rad[static_cast<std::size_t>(row)] = kSmallScanStep_rad * (39.5 - row);
  for (int col = 0; col < 120; ++col)
    image.azimuth_rad[static_cast<std::size_t>(col)] = std::acos(0.0) + kSmallScanStep_rad * (col - 59.5);
  for (int row = 0; row < 80; ++row)
    for (int col = 0; col < 120; ++col) {
      const std::size_t i = image.index(row, col);
      const double el = image.elevation_rad[static_cast<std::size_t>(row)],
                   az = image.azimuth_rad[static_cast<std::size_t>(col)];
      const Vec3 ray(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const double r = range(ray);
      image.range_m[i] = static_cast<float>(r);
      image.x[i] = static_cast<float>(r * ray.x());
      image.y[i] = static_cast<float>(r * ray.y());
      image.z[i] = static_cast<float>(r * ray.z());
      image.mask[i] = kMeasured;
    }
  return image;
}

// Scans of nothing but their images, where the world stands.
inline std::vector<stages::SightScan> bare_scans(const std::vector<RangeImage>& images) {
  std::vector<stages::SightScan> scans;
  for (const RangeImage& image : images) scans.push_back({&image, nullptr, nullptr, {}, nullptr});
  return scans;
}

// The same wall from 3 m farther left, with nothing before it that this scanner sees.
inline double wall_alone(const Vec3& ray) {
  return 4 / ray.y();
}

// A column behind a wall that hides it, and scans from the same place that see it or through it.
class ColumnBehindAWall : public ::testing::Test {
 protected:
  ColumnBehindAWall() {
    column.foot = {0, 6, -0.5};
    column.length_m = 1;
    column.radius_m = 0.3;
    columns = {column};
  }

  Cylinder column;
  std::vector<Cylinder> columns;
  RangeImage hiding = scan_of(wall_alone), through = scan_of([](const Vec3&ray) { return 9 / ray.y(); });
};

}  // namespace hybrid::testing
