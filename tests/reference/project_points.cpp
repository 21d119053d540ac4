#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "cases/project_points_case.hpp"

namespace hybrid::testing {
namespace {

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

// OpenCV's manual written down, calib3d and fisheye: image coordinates of a direction (x, y, 1).
Vec2 bend(const Camera& c, double x, double y) {
  const double r = std::hypot(x, y), r2 = r * r, r4 = r2 * r2, r6 = r4 * r2;
  if (c.lens == Lens::fisheye) {
    const double a = std::atan(r);
    const double bent =
        a + c.k1 * std::pow(a, 3) + c.k2 * std::pow(a, 5) + c.k3 * std::pow(a, 7) + c.k4 * std::pow(a, 9);
    return r == 0 ? Vec2(0, 0) : Vec2(x * bent / r, y * bent / r);
  }
  const double q = (1 + c.k1 * r2 + c.k2 * r4 + c.k3 * r6) / (1 + c.k4 * r2 + c.k5 * r4 + c.k6 * r6);
  return {x * q + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
          y * q + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
}

// A panorama by its meaning: turn the direction until its azimuth is 0 and read off how much; columns that
// are a full turn apart are one.
Vec2 unroll(const Camera& c, const Vec3& p) {
  const double level = std::sqrt(p.x() * p.x() + p.z() * p.z());
  double azimuth = std::acos(p.z() / level);
  if (p.x() < 0) azimuth = -azimuth;
  const double up = c.lens == Lens::cylindrical ? p.y() / level : std::asin(p.y() / p.norm());
  const double column = std::fmod(c.cx + c.fx * azimuth + 2 * M_PI * c.fx, 2 * M_PI * c.fx);
  return {column, c.cy + c.fy * up};
}

// Does the radial part grow all the way from the axis to this radius? Walked in small steps.
bool grows_until(const Camera& radial, double r) {
  double before = 0;
  const double angle = std::atan(r);
  for (int i = 1; i <= 100; ++i) {
    const double now = bend(radial, std::tan(angle * i / 100), 0).x();
    if (!(now > before)) return false;
    before = now;
  }
  return true;
}

}  // namespace

ProjectPointsCase::Output ProjectPointsCase::reference(const Input& input) {
  const Camera& c = input.photograph.camera;
  Camera radial = c;
  radial.p1 = radial.p2 = 0;
  const Mat3 cam_from_world = input.photograph.cam_from_world.rotation.toRotationMatrix();
  Output out;
  for (std::size_t i = 0; i < input.points.size(); i += 3) {
    const Vec3 world(input.points[i], input.points[i + 1], input.points[i + 2]);
    const Vec3 p = cam_from_world * world + input.photograph.cam_from_world.translation;
    const double x = p.x() / p.z(), y = p.y() / p.z();
    const bool panorama = c.lens == Lens::spherical || c.lens == Lens::cylindrical;
    const Vec2 bent = bend(c, x, y);
    const Vec2 pixel = panorama ? unroll(c, p) : Vec2(c.fx * bent.x() + c.cx, c.fy * bent.y() + c.cy);
    const bool seen = (panorama || (p.z() > 0 && grows_until(radial, std::hypot(x, y)))) && pixel.x() >= 0 &&
                      pixel.x() < c.width && pixel.y() >= 0 && pixel.y() < c.height;
    // The ray back through the pixel is the one that came: from the camera's centre to the point.
    const Vec3 ray = cam_from_world.transpose() * p.normalized();
    for (int k = 0; k < 2; ++k) out.pixels.push_back(static_cast<float>(seen ? pixel[k] : kNotSeen));
    for (int k = 0; k < 3; ++k) out.rays.push_back(static_cast<float>(seen ? ray[k] : kNotSeen));
  }
  return out;
}

}  // namespace hybrid::testing
