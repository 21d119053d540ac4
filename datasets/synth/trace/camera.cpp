#include "trace/camera.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace synth {

Vec3 Camera::ray_direction(double x_px, double y_px) const {
  if (spherical) {
    const double right = (x_px - centre_x_px) / focal_px, down = (y_px - centre_y_px) / focal_px;
    const Vec3 in_camera(std::sin(right) * std::cos(down), std::sin(down), std::cos(right) * std::cos(down));
    return (camera_from_world_rotation.transpose() * in_camera).normalized();
  }
  const Eigen::Vector2d distorted((x_px - centre_x_px) / focal_px, (y_px - centre_y_px) / focal_px);
  // Newton on the radius: s (1 + k1 s^2 + k2 s^4) = |distorted|, monotone over the image for our small k.
  const double radius = distorted.norm();
  double s = radius;
  for (int step = 0; step < 8; ++step) {
    const double s2 = s * s;
    s -= (s * (1 + s2 * (k1 + k2 * s2)) - radius) / (1 + s2 * (3 * k1 + 5 * k2 * s2));
  }
  const double scale = radius > 0 ? s / radius : 1.0;
  const Vec3 in_camera(distorted.x() * scale, distorted.y() * scale, 1);
  return (camera_from_world_rotation.transpose() * in_camera).normalized();
}

std::optional<Eigen::Vector2d> Camera::project(const Vec3& point_in_world) const {
  const Vec3 p = camera_from_world_rotation * (point_in_world - eye);
  if (spherical)
    return Eigen::Vector2d(centre_x_px + focal_px * std::atan2(p.x(), p.z()),
                           centre_y_px + focal_px * std::asin(p.y() / p.norm()));
  if (p.z() <= 0) return std::nullopt;
  const Eigen::Vector2d flat(p.x() / p.z(), p.y() / p.z());
  const double r2 = flat.squaredNorm();
  if (r2 > 2) return std::nullopt;  // beyond every image corner; the polynomial folds back farther out
  const double bend = 1 + r2 * (k1 + k2 * r2);
  const Eigen::Vector2d pixel(focal_px * bend * flat.x() + centre_x_px,
                              focal_px * bend * flat.y() + centre_y_px);
  if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= width_px || pixel.y() >= height_px) return std::nullopt;
  return pixel;
}

Eigen::Matrix3d look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double roll_rad) {
  const Vec3 forward = (target - eye).normalized();
  const Vec3 right = forward.cross(up).normalized();
  const Vec3 down = forward.cross(right);
  Eigen::Matrix3d rotation;
  rotation.row(0) = std::cos(roll_rad) * right + std::sin(roll_rad) * down;
  rotation.row(1) = std::cos(roll_rad) * down - std::sin(roll_rad) * right;
  rotation.row(2) = forward;
  return rotation;
}

Camera photograph_camera(std::size_t index, const Preset& preset, double horizontal_fov_deg) {
  Camera camera;
  camera.name = fmt::format("{:03}.jpg", index);
  camera.width_px = preset.photograph_width_px;
  camera.height_px = preset.photograph_height_px;
  camera.focal_px = camera.width_px / 2.0 / std::tan(horizontal_fov_deg / 2 * (std::numbers::pi / 180));
  camera.centre_x_px = camera.width_px * 0.5035;  // a real lens is not centred
  camera.centre_y_px = camera.height_px * 0.4970;
  camera.k1 = -0.06;
  camera.k2 = 0.02;
  return camera;
}

Camera panorama(const std::string& name, int width_px, const Eigen::Matrix3d& world_from_scan_rotation,
                const Vec3& eye) {
  Camera camera;
  camera.name = name;
  camera.spherical = true;
  camera.width_px = width_px;
  camera.height_px = width_px / 2;
  camera.focal_px = width_px / (2 * std::numbers::pi);
  camera.centre_x_px = camera.width_px / 2.0;
  camera.centre_y_px = camera.height_px / 2.0;
  camera.camera_from_world_rotation.row(0) = -world_from_scan_rotation.col(1);
  camera.camera_from_world_rotation.row(1) = -world_from_scan_rotation.col(2);
  camera.camera_from_world_rotation.row(2) = world_from_scan_rotation.col(0);
  camera.eye = eye;
  return camera;
}

Camera pinhole(const std::string& name, int width_px, int height_px, double vertical_fov_deg, const Vec3& eye,
               const Vec3& target) {
  Camera camera;
  camera.name = name;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.focal_px = height_px / 2.0 / std::tan(vertical_fov_deg * std::numbers::pi / 360);
  camera.centre_x_px = width_px / 2.0;
  camera.centre_y_px = height_px / 2.0;
  camera.eye = eye;
  camera.camera_from_world_rotation = look_at(eye, target, Vec3::UnitZ());
  return camera;
}

}  // namespace synth
