#include "score/read/camera.hpp"

#include <cmath>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

// Radius of the undistorted ray for a distorted one: r (1 + k1 r^2 + k2 r^4) = distorted, by bisection on the
// part where the left side grows.
double undistorted_radius(double distorted, double k1, double k2) {
  const auto bent = [&](double r) { return r * (1 + r * r * (k1 + k2 * r * r)); };
  double low = 0, high = 2 * distorted + 1e-12;
  while (bent(high) < distorted && high < 100) high *= 1.5;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (bent(middle) < distorted ? low : high) = middle;
  }
  return (low + high) / 2;
}

// Where the image radius stops growing with the ray's: beyond it the polynomial folds back.
double find_fold(double k1, double k2) {
  const auto slope = [&](double r2) { return 1 + r2 * (3 * k1 + 5 * k2 * r2); };
  for (double r = 0; r < 10; r += 0.01)
    if (slope(r * r) <= 0) return r;
  return 1e9;
}

}  // namespace

Vec3 Camera::ray(double x_px, double y_px) const {
  Vec2 flat((x_px - centre_x_px) / focal_x_px, (y_px - centre_y_px) / focal_y_px);
  const double radius = flat.norm();
  if ((k1 != 0 || k2 != 0) && radius > 0) flat *= undistorted_radius(radius, k1, k2) / radius;
  return (world_from_camera * Vec3(flat.x(), flat.y(), 1)).normalized();
}

std::optional<Vec2> Camera::pixel_of(const Vec3& in_world) const {
  const Vec3 p = world_from_camera.transpose() * (in_world - eye);
  if (p.z() <= 0) return std::nullopt;
  const Vec2 flat(p.x() / p.z(), p.y() / p.z());
  const double r2 = flat.squaredNorm();
  if (r2 > fold_radius * fold_radius) return std::nullopt;
  const double bend = 1 + r2 * (k1 + k2 * r2);
  const Vec2 pixel(focal_x_px * bend * flat.x() + centre_x_px, focal_y_px * bend * flat.y() + centre_y_px);
  const bool inside = pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width_px && pixel.y() < height_px;
  return inside ? std::optional<Vec2>(pixel) : std::nullopt;
}

Camera json_camera(const nlohmann::json& entry) {
  Camera camera;
  camera.name = entry.at("name").get<std::string>();
  camera.width_px = entry.at("size_px").at(0).get<int>();
  camera.height_px = entry.at("size_px").at(1).get<int>();
  const auto model = entry.at("model").get<std::string>();
  const auto p = entry.at("parameters").get<std::vector<double>>();
  const auto expect = [&](std::size_t count) {
    if (p.size() != count)
      bad_input("camera {}: {} has {} parameters, found {}", camera.name, model, count, p.size());
  };
  std::size_t next = 1;  // SIMPLE_ and RADIAL models: one focal length
  if (model == "SIMPLE_PINHOLE") {
    expect(3);
  } else if (model == "SIMPLE_RADIAL") {
    expect(4);
    camera.k1 = p[3];
  } else if (model == "RADIAL") {
    expect(5);
    camera.k1 = p[3];
    camera.k2 = p[4];
  } else if (model == "PINHOLE") {
    expect(4);
    next = 2;
  } else {
    bad_input("camera {}: expected model PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL or RADIAL, found {}",
              camera.name, model);
  }
  camera.focal_x_px = p[0];
  camera.focal_y_px = p[next - 1];
  camera.centre_x_px = p[next];
  camera.centre_y_px = p[next + 1];
  camera.fold_radius = find_fold(camera.k1, camera.k2);
  const Similarity pose = json_pose(entry.at("world_from_camera"));
  camera.world_from_camera = pose.rotation;
  camera.eye = pose.translation;
  return camera;
}

}  // namespace score
