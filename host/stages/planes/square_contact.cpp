#include "stages/planes/square_contact.hpp"

#include <algorithm>
#include <cmath>

#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

bool in_contact(const RangeImage& image, const SquarePlanes& squares, const ContactLimits& limits,
                const SquareRecord& a, const SquareRecord& b) {
  if (b.state != SQUARE_PLANAR) return false;
  const Vec3 na = square_normal(a), nb = square_normal(b);
  const double angle = std::atan2(na.cross(nb).norm(), na.dot(nb));
  const double sigma = std::hypot(a.sigma_normal, b.sigma_normal);
  if (angle > limits.most_turn_rad + limits.angle_sigmas * sigma) return false;
  const Vec3 step = square_centroid(b) - square_centroid(a);
  const double distance = step.norm(), range = square_centroid(a).norm();
  const double angular = image.step_rad();
  const double cosine = std::max(std::abs(na.dot(square_centroid(a))) / range, 0.1);
  const double noise = limits.offset_sigmas * squares.sigma_m;
  if (distance > limits.distance_factor * squares.square * range * angular / cosine + noise) return false;
  return std::max(std::abs(step.dot(na)), std::abs(step.dot(nb))) < distance * std::sin(angle) + noise;
}

}  // namespace hybrid::stages
