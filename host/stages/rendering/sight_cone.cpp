#include "stages/rendering/sight_cone.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid::stages {
namespace {

constexpr int kPerSide = 32;      // places looked at along each side of a photograph
constexpr double kMargin = 1.02;  // for what lies between them, and for rounding

// Between the axis and the farthest direction in the photograph: along its border, as lenses bend.
double half_angle_rad(const Camera& camera) {
  if (camera.panorama()) return std::numbers::pi;
  double least = 1;  // cosine
  for (int i = 0; i <= kPerSide; ++i) {
    const double x = camera.width * i / double{kPerSide}, y = camera.height * i / double{kPerSide};
    for (const Vec2& place : {Vec2(x, 0), Vec2(x, camera.height), Vec2(0, y), Vec2(camera.width, y)}) {
      const double cosine = camera.ray(place).z();
      if (!(cosine > 0)) return std::numbers::pi / 2;  // past where the lens folds back
      least = std::min(least, cosine);
    }
  }
  return std::min(std::numbers::pi / 2, kMargin * std::acos(least));
}

}  // namespace

SightCone::SightCone(const Photograph& photograph)
    : apex(photograph.centre()),
      axis(photograph.cam_from_world.inverse().rotate(Vec3::UnitZ())),
      half_rad(half_angle_rad(photograph.camera)) {}

bool SightCone::meets_ball(const Vec3& centre, double radius_m) const {
  const Vec3 to = centre - apex;
  const double far_m = to.norm();
  if (!(radius_m < far_m)) return true;
  const double off_axis_rad = std::acos(std::clamp(axis.dot(to) / far_m, -1.0, 1.0));
  return off_axis_rad - std::asin(radius_m / far_m) <= half_rad;
}

}  // namespace hybrid::stages
