#include "cases/blend_photos_case.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/colour.hpp"
#include "reference/shadow.hpp"

namespace hybrid::testing {
namespace {

// Bilinear between pixel centres, the border repeated; value(x, y) gives a pixel.
template <typename Value>
Vec3 sample(const Camera& camera, const Vec2& position, const Value& value) {
  const Vec2 p = (position - Vec2(0.5, 0.5)).cwiseMax(0).cwiseMin(Vec2(camera.width - 1, camera.height - 1));
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const int x1 = std::min(x + 1, camera.width - 1), y1 = std::min(y + 1, camera.height - 1);
  const double u = p.x() - x, v = p.y() - y;
  return (1 - v) * ((1 - u) * value(x, y) + u * value(x1, y)) +
         v * ((1 - u) * value(x, y1) + u * value(x1, y1));
}

}  // namespace

BlendPhotosCase::Input BlendPhotosCase::make(std::size_t size, std::uint32_t seed) {
  Input input;
  input.scene = RayScene::make(40, 60, seed);
  input.eye = {1, -8, 2};
  input.cols = static_cast<std::uint32_t>(size > 1000 ? 101 : size);
  input.rows = static_cast<std::uint32_t>(size > 1000 ? size / 101 : 1);
  for (int i = 0; i < 256; ++i) input.linear.push_back(static_cast<float>(linear_from_srgb(i / 255.0)));

  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<float> place(-4, 4), part(-1, 1);
  for (const Vec3& eye : {Vec3(0, -9, 1), Vec3(7, -6, 0), Vec3(-5, -7, -3)}) {
    Photo photo{look_at(eye, Vec3::Zero(), {0, 0, 1}, 50, 60, 44), {}, {}};
    photo.photograph.camera.k1 = -0.1, photo.photograph.camera.k2 = 0.02;
    photo.photograph.camera.p1 = 0.003, photo.photograph.camera.p2 = -0.002;
    for (int i = 0; i < 4 * 60 * 44; ++i) {
      photo.pixels.push_back(static_cast<std::uint8_t>(random() % 256));
      photo.low.push_back(static_cast<float>(random() % 256) / 256);
    }
    input.photos.push_back(std::move(photo));
  }

  const std::size_t count = input.count();
  input.surface.assign(SURFACE_PLANES * count, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 13 == 12) continue;
    const Vec3f normal = Vec3f(part(random), -std::abs(part(random)) - 0.01f, part(random)).normalized();
    const float radius = i % 3 == 0   ? 0.0f
                         : i % 3 == 1 ? 0.03f
                                      : -0.01f;  // face, splat, splat without normal
    for (std::size_t k = 0; k < 3; ++k) {
      input.surface[(SURFACE_X + k) * count + i] = place(random);
      input.surface[(SURFACE_NORMAL_X + k) * count + i] = normal[static_cast<int>(k)];
    }
    input.surface[SURFACE_RADIUS * count + i] = radius;
  }
  return input;
}

BlendPhotosCase::Output BlendPhotosCase::reference(const Input& input) {
  const std::size_t count = input.count();
  Output out{std::vector<float>(BLEND_PLANES * count, 0), std::vector<std::uint32_t>(count, 0),
             std::vector<std::int32_t>(count, -1)};
  const Vec3 eye(input.eye[0], input.eye[1], input.eye[2]);
  for (std::size_t i = 0; i < count; ++i) {
    const auto plane = [&](std::size_t p) { return double{input.surface[p * count + i]}; };
    const Vec3 point(plane(SURFACE_X), plane(SURFACE_Y), plane(SURFACE_Z));
    const Vec3 normal(plane(SURFACE_NORMAL_X), plane(SURFACE_NORMAL_Y), plane(SURFACE_NORMAL_Z));
    const double radius = plane(SURFACE_RADIUS);
    double sum_weight = 0, best_weight = 0;
    Vec3 sum = Vec3::Zero(), best = Vec3::Zero();
    for (std::size_t j = 0; j < input.photos.size() && point.allFinite(); ++j) {
      const Photograph& photograph = input.photos[j].photograph;
      const Camera& camera = photograph.camera;
      const auto pixel = camera.project(photograph.cam_from_world * point);
      if (!pixel) continue;
      const Vec3 centre = photograph.centre();
      const double distance = (point - centre).norm();
      const Vec3 direction = (point - centre) / distance;
      const double facing = radius < 0 ? 1 : -normal.dot(direction);
      if (facing <= 0) continue;
      const double stretch = 1 / std::max(facing, 0.2);
      const double clear_of_faces = (radius == 0 ? input.face_tolerance_m : input.tolerance_m) * stretch;
      const double clear_of_spheres = std::max<double>(input.tolerance_m, 2 * std::abs(radius)) * stretch;
      bool blocked = false;
      for (const auto& t : input.scene.triangles)
        blocked |= triangle_distance(centre, direction, t) < distance - clear_of_faces;
      for (const auto& s : input.scene.spheres)
        blocked |= sphere_distance(centre, direction, s) < distance - clear_of_spheres - 2 * s.radius;
      if (blocked) continue;

      const double border =
          std::min({pixel->x(), pixel->y(), camera.width - pixel->x(), camera.height - pixel->y()});
      const double feather = input.feather_px > 0 ? std::clamp(border / input.feather_px, 1e-6, 1.0) : 1;
      const Vec3 to_eye = (eye - point).normalized();
      const double angle = std::atan2(to_eye.cross(-direction).norm(), to_eye.dot(-direction));
      const double weight = feather / (angle + 0.001);
      const Vec3 light = sample(camera, *pixel, [&](int x, int y) {
        const std::uint8_t* bytes = input.photos[j].pixels.data() + 4 * (y * camera.width + x);
        return Vec3(linear_from_srgb(bytes[0] / 255.0), linear_from_srgb(bytes[1] / 255.0),
                    linear_from_srgb(bytes[2] / 255.0));
      });
      const Vec3 low = sample(camera, *pixel, [&](int x, int y) {
        const float* value = input.photos[j].low.data() + 4 * (y * camera.width + x);
        return Vec3(value[0], value[1], value[2]);
      });
      const bool dual = input.mode == BLEND_DUAL;
      sum += weight * (dual ? low : light);
      sum_weight += weight;
      ++out.seen[i];
      if (weight > best_weight) {
        best_weight = weight;
        best = dual ? light - low : light;
        out.best[i] = static_cast<std::int32_t>(j);
      }
    }
    const double planes[BLEND_PLANES] = {sum.x(),  sum.y(),  sum.z(),  sum_weight,
                                         best.x(), best.y(), best.z(), best_weight};
    for (std::size_t p = 0; p < BLEND_PLANES; ++p) out.sums[p * count + i] = static_cast<float>(planes[p]);
  }
  return out;
}

}  // namespace hybrid::testing
