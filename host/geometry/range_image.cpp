#include "geometry/range_image.hpp"

#include <cmath>
#include <limits>

namespace hybrid {

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
