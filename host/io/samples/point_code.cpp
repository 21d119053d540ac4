#include "io/samples/point_code.hpp"

#include <cmath>

#include "io/samples/columns.hpp"

namespace hybrid::io {
namespace {

// The longest axis first.
std::array<int, 3> axes_of(const Vec3& ray) {
  const double x = std::abs(ray.x()), y = std::abs(ray.y()), z = std::abs(ray.z());
  if (x >= y && x >= z) return {0, 1, 2};
  if (y >= z) return {1, 0, 2};
  return {2, 0, 1};
}

}  // namespace

PointCode::Folded PointCode::encode(const Vec3& ray, double range, const Point& point) const {
  const auto axes = axes_of(ray);
  Folded folded{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float value = point[static_cast<std::size_t>(axes[k])];
    folded[k] = fold(number_.encode(value) - predict(ray, range, axes[k]));
    if (k == 0) range = range_of(ray, axes[0], value);
  }
  return folded;
}

PointCode::Point PointCode::decode(const Vec3& ray, double range, const Folded& folded) const {
  const auto axes = axes_of(ray);
  Point point{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float value = number_.decode(predict(ray, range, axes[k]) + unfold(folded[k]));
    point[static_cast<std::size_t>(axes[k])] = value;
    if (k == 0) range = range_of(ray, axes[0], value);
  }
  return point;
}

}  // namespace hybrid::io
