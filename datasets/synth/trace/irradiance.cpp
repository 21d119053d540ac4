#include "trace/irradiance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace synth {

double form_factor(const Vec3& point, const Vec3& normal, const std::array<Vec3, 4>& corners) {
  // Clip to the horizon (Sutherland and Hodgman); a quadrilateral against one plane leaves at most five
  // corners.
  std::array<Vec3, 8> ring;
  std::size_t count = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 a = corners[k] - point, b = corners[(k + 1) % corners.size()] - point;
    const double height_a = normal.dot(a), height_b = normal.dot(b);
    if (height_a > 0) ring[count++] = a;
    if ((height_a > 0) != (height_b > 0)) ring[count++] = a + (b - a) * (height_a / (height_a - height_b));
  }
  if (count < 3) return 0;
  for (std::size_t k = 0; k < count; ++k) ring[k].normalize();
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 &a = ring[k], &b = ring[(k + 1) % count];
    const Vec3 across = a.cross(b);
    const double sine = across.norm();
    if (sine > 1e-12) sum += std::atan2(sine, a.dot(b)) * normal.dot(across) / sine;
  }
  // Seen from the lit side the ring runs clockwise around the receiver's direction.
  return std::max(0.0, -sum / (2 * std::numbers::pi));
}

}  // namespace synth
