#include "geometry/range_image.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace hybrid {

bool is_full_turn(const std::vector<double>& azimuth_rad) {
  constexpr double kTurn = 2 * std::numbers::pi, kOpenGap = 3;  // columns
  if (azimuth_rad.size() < 2) return false;
  const double turn = azimuth_rad.back() - azimuth_rad.front();
  return kTurn - std::abs(turn) <= kOpenGap * (turn / static_cast<double>(azimuth_rad.size() - 1));
}

RangeImage make_range_image(int rows, int cols) {
  RangeImage image;
  image.rows = rows;
  image.cols = cols;
  image.elevation_rad.assign(static_cast<std::size_t>(rows), 0.0);
  image.azimuth_rad.assign(static_cast<std::size_t>(cols), 0.0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  image.range_m.assign(image.count(), nan);
  image.x = image.y = image.z = image.range_m;
  image.mask.assign(image.count(), kEmpty);
  image.source.assign(image.count(), kNoSource);
  return image;
}

}  // namespace hybrid
