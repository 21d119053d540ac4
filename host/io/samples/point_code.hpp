#pragma once
#include <array>

#include "geometry/plane.hpp"
#include "io/samples/number_code.hpp"

namespace hybrid::io {

// A measured point as its differences from a prediction: along the longest axis of the node's ray from where
// a plane (or the sample before it) says the range is, along the two others from the ray through what the
// first axis has fixed. So the noise of the range is written once, and what is left of the other axes is
// rounding and the scanner's deviation from the grid's ray.
//
// Encoding and decoding take the same steps in the same order, in +, -, *, / alone, which give the same bits
// everywhere.
class PointCode {
 public:
  PointCode(NumberCode number, const Vec3& origin) : number_(number), origin_(origin) {}

  using Point = std::array<float, 3>;           // relative to the origin
  using Folded = std::array<std::uint32_t, 3>;  // of the differences; first the longest axis

  Folded encode(const Vec3& ray, double range, const Point& point) const;
  Point decode(const Vec3& ray, double range, const Folded& folded) const;

 private:
  std::uint32_t predict(const Vec3& ray, double range, int axis) const {
    return number_.encode(range * ray[axis] - origin_[axis]);
  }
  // Where along the ray the point lies, by one of its coordinates.
  double range_of(const Vec3& ray, int axis, float value) const {
    return (static_cast<double>(value) + origin_[axis]) / ray[axis];
  }

  NumberCode number_;
  Vec3 origin_;
};

// Range at which the ray (unit, from the scanner) meets the plane; not positive or not finite where it does
// not.
inline double range_to(const Plane& plane, const Vec3& ray) {
  return plane.offset_m /
         (plane.normal.x() * ray.x() + plane.normal.y() * ray.y() + plane.normal.z() * ray.z());
}

}  // namespace hybrid::io
