#include "geometry/camera.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace hybrid {
namespace {

Vec2 distort(const Camera& c, const Vec2& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1 + r2 * (c.k1 + r2 * c.k2);
  return {p.x() * radial + 2 * c.p1 * p.x() * p.y() + c.p2 * (r2 + 2 * p.x() * p.x()),
          p.y() * radial + 2 * c.p2 * p.x() * p.y() + c.p1 * (r2 + 2 * p.y() * p.y())};
}

}  // namespace

double Camera::max_radius2() const {
  // d/dr of r (1 + k1 r^2 + k2 r^4) = 1 + 3 k1 s + 5 k2 s^2 with s = r^2; its smallest positive root.
  const double infinite = std::numeric_limits<double>::infinity();
  if (k2 == 0) return k1 < 0 ? -1 / (3 * k1) : infinite;
  const double a = 5 * k2, b = 3 * k1, discriminant = b * b - 4 * a;
  if (discriminant < 0) return infinite;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double smallest = infinite;
  for (double root : {q / a, 1 / q})
    if (root > 0 && root < smallest) smallest = root;
  return smallest;
}

std::optional<Vec2> Camera::project(const Vec3& point_in_cam) const {
  if (!(point_in_cam.z() > 0)) return std::nullopt;
  const Vec2 p = point_in_cam.head<2>() / point_in_cam.z();
  if (!(p.squaredNorm() < max_radius2())) return std::nullopt;
  const Vec2 d = distort(*this, p);
  const Vec2 pixel(fx * d.x() + cx, fy * d.y() + cy);
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width && pixel.y() < height)) return std::nullopt;
  return pixel;
}

Vec3 Camera::ray(const Vec2& pixel) const {
  const Vec2 target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Vec2 p = target;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vec2 error = distort(*this, p) - target;
    if (error.squaredNorm() < 1e-24) break;
    const double r2 = p.squaredNorm(), x = p.x(), y = p.y();
    const double radial = 1 + r2 * (k1 + r2 * k2), slope = 2 * (k1 + 2 * k2 * r2);
    Eigen::Matrix2d jacobian;
    jacobian << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, x * y * slope + 2 * p1 * x + 2 * p2 * y,
        x * y * slope + 2 * p2 * y + 2 * p1 * x, radial + y * y * slope + 2 * p2 * x + 6 * p1 * y;
    p -= jacobian.inverse() * error;
  }
  return Vec3(p.x(), p.y(), 1).normalized();
}

Photograph look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double fov_deg, int width,
                   int height) {
  if (!eye.allFinite() || !target.allFinite() || !up.allFinite())
    fail_input("view: eye, target and up: expected finite numbers");
  if (!(fov_deg > 0 && fov_deg < 170))
    fail_input("view: fov_deg: expected more than 0, below 170, found {}", fov_deg);
  if (width < 1 || height < 1)
    fail_input("view: size: expected at least 1 x 1, found {} x {}", width, height);
  const Vec3 forward = (target - eye).normalized();
  if ((target - eye).norm() < 1e-9) fail_input("view: eye and target coincide; move one of them");
  const Vec3 right = forward.cross(up);
  if (right.norm() < 1e-6 * up.norm() || up.norm() == 0)
    fail_input("view: up is parallel to the direction from eye to target; choose another up");
  Mat3 cam_from_world;
  cam_from_world.row(0) = right.normalized();
  cam_from_world.row(1) = forward.cross(right.normalized());
  cam_from_world.row(2) = forward;
  Photograph view;
  view.camera.width = width;
  view.camera.height = height;
  view.camera.fx = view.camera.fy = 0.5 * height / std::tan(0.5 * fov_deg * std::numbers::pi / 180);
  view.camera.cx = 0.5 * width;
  view.camera.cy = 0.5 * height;
  view.cam_from_world.rotation = Eigen::Quaterniond(cam_from_world);
  view.cam_from_world.translation = -(cam_from_world * eye);
  return view;
}

}  // namespace hybrid
