#include "geometry/st_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"

namespace hybrid {

bool is_distorted(const Camera& c) {
  if (c.panorama()) return false;
  return c.lens == Lens::fisheye || c.k1 != 0 || c.k2 != 0 || c.p1 != 0 || c.p2 != 0 || c.k3 != 0 ||
         c.k4 != 0 || c.k5 != 0 || c.k6 != 0;
}

Camera pinhole_of(const Camera& camera) {
  // How far the border's pixels come to lie beyond it, in whole pixels; at most half the size on each side.
  int left = 0, top = 0, right = 0, bottom = 0;
  const int most_x = camera.width / 2, most_y = camera.height / 2;
  const auto reach = [&](double x, double y) {
    const Vec3 ray = camera.ray({x, y});
    if (!ray.allFinite() || !(ray.z() > 1e-6)) {  // at or behind the image plane
      if (x <= 0) left = most_x;
      if (x >= camera.width) right = most_x;
      if (y <= 0) top = most_y;
      if (y >= camera.height) bottom = most_y;
      return;
    }
    const double column = camera.fx * ray.x() / ray.z() + camera.cx;
    const double row = camera.fy * ray.y() / ray.z() + camera.cy;
    const auto beyond = [](double px, int most) {
      return px > most ? most : static_cast<int>(std::ceil(std::max(0.0, px - 1e-6)));
    };
    left = std::max(left, beyond(-column, most_x));
    right = std::max(right, beyond(column - camera.width, most_x));
    top = std::max(top, beyond(-row, most_y));
    bottom = std::max(bottom, beyond(row - camera.height, most_y));
  };
  for (int x = 0; x <= camera.width; ++x)
    for (const int y : {0, camera.height}) reach(x, y);
  for (int y = 0; y <= camera.height; ++y)
    for (const int x : {0, camera.width}) reach(x, y);
  Camera pinhole;
  pinhole.width = camera.width + left + right;
  pinhole.height = camera.height + top + bottom;
  pinhole.fx = camera.fx;
  pinhole.fy = camera.fy;
  pinhole.cx = camera.cx + left;
  pinhole.cy = camera.cy + top;
  return pinhole;
}

ImageF st_map(const Camera& target, const Camera& source) {
  ImageF map(target.width, target.height, 2, -1.0f);
  parallel_for(static_cast<std::size_t>(target.height), [&](std::size_t row) {
    for (int col = 0; col < target.width; ++col) {
      const Vec3 ray = target.ray({col + 0.5, static_cast<double>(row) + 0.5});
      if (!ray.allFinite()) continue;
      const auto pixel = source.project(ray);
      if (!pixel) continue;
      float* st = map.at(col, static_cast<int>(row));
      st[0] = static_cast<float>(pixel->x() / source.width);
      st[1] = static_cast<float>(1 - pixel->y() / source.height);
    }
  });
  return map;
}

}  // namespace hybrid
