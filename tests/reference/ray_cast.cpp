#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "cases/ray_cast_case.hpp"
#include "reference/shadow.hpp"

namespace hybrid::testing {

double triangle_distance(const Vec3& origin, const Vec3& direction, const TriangleRecord& t) {
  Mat3 system;
  system.col(0) = Vec3(t.b[0], t.b[1], t.b[2]) - Vec3(t.a[0], t.a[1], t.a[2]);
  system.col(1) = Vec3(t.c[0], t.c[1], t.c[2]) - Vec3(t.a[0], t.a[1], t.a[2]);
  system.col(2) = -direction;
  const Vec3 solved = system.inverse() * (origin - Vec3(t.a[0], t.a[1], t.a[2]));
  const bool inside = solved.x() >= 0 && solved.y() >= 0 && solved.x() + solved.y() <= 1 && solved.z() > 0;
  return inside ? solved.z() : std::numeric_limits<double>::infinity();
}

double sphere_distance(const Vec3& origin, const Vec3& direction, const SphereRecord& s) {
  const Vec3 to_centre = Vec3(s.centre[0], s.centre[1], s.centre[2]) - origin;
  const double along = to_centre.dot(direction);
  const double root = double{s.radius} * s.radius - (to_centre - along * direction).squaredNorm();
  const double entry = root > 0 ? along - std::sqrt(root) : -1;
  return entry > 0 ? entry : std::numeric_limits<double>::infinity();
}

namespace {

// The disc across the normal; the sphere where there is no normal.
double patch_distance(const Vec3& origin, const Vec3& direction, const SphereRecord& s,
                      const SphereSurface& surface) {
  const Vec3 normal(surface.normal[0], surface.normal[1], surface.normal[2]);
  if (normal.isZero()) return sphere_distance(origin, direction, s);
  const Vec3 centre(s.centre[0], s.centre[1], s.centre[2]);
  const double t = normal.dot(centre - origin) / normal.dot(direction);
  const bool starts_inside = (centre - origin).norm() <= s.radius;
  const bool met = t > 0 && (origin + t * direction - centre).norm() < s.radius && !starts_inside;
  return met ? t : std::numeric_limits<double>::infinity();
}

}  // namespace

RayCastCase::Output RayCastCase::reference(const Input& input) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t count = input.count();
  Output out{std::vector<float>(count, INFINITY), std::vector<std::uint32_t>(count, 0),
             std::vector<float>(SURFACE_PLANES * count, nan)};
  const Vec3 origin(input.origin[0], input.origin[1], input.origin[2]);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 direction(input.directions[3 * i], input.directions[3 * i + 1], input.directions[3 * i + 2]);
    if (!direction.allFinite()) continue;
    const TriangleRecord* triangle = nullptr;
    double t_triangle = INFINITY, t_sphere = INFINITY;
    std::size_t sphere = 0;
    for (const auto& candidate : input.scene.triangles)
      if (const double t = triangle_distance(origin, direction, candidate); t < t_triangle) {
        t_triangle = t;
        triangle = &candidate;
      }
    for (std::size_t k = 0; k < input.scene.spheres.size(); ++k)
      if (const double t = patch_distance(origin, direction, input.scene.spheres[k], input.scene.surfaces[k]);
          t < t_sphere) {
        t_sphere = t;
        sphere = k;
      }
    if (std::isinf(t_triangle) && std::isinf(t_sphere)) continue;

    Vec3 normal = Vec3::Zero();
    if (triangle) {
      const Vec3 a(triangle->a[0], triangle->a[1], triangle->a[2]);
      normal = (Vec3(triangle->b[0], triangle->b[1], triangle->b[2]) - a)
                   .cross(Vec3(triangle->c[0], triangle->c[1], triangle->c[2]) - a)
                   .normalized();
    }
    const double cosine = std::max(std::abs(normal.dot(direction)), 0.1);
    const bool sphere_wins =
        !std::isinf(t_sphere) && (!triangle || (t_sphere - t_triangle) * cosine <= input.tolerance_m);
    const double t = sphere_wins ? t_sphere : t_triangle;
    const Vec3 point = origin + t * direction;
    double radius = triangle ? triangle->radius : 0;
    if (sphere_wins) {
      const auto& record = input.scene.spheres[sphere];
      const float* known = input.scene.surfaces[sphere].normal;
      normal = Vec3(known[0], known[1], known[2]);
      radius = record.radius;
      if (normal.isZero()) {
        normal = (point - Vec3(record.centre[0], record.centre[1], record.centre[2])) / radius;
        radius = -radius;
      }
    }
    if (normal.dot(direction) > 0) normal = -normal;
    out.distance[i] = static_cast<float>(t);
    out.id[i] = sphere_wins ? input.scene.surfaces[sphere].id : triangle->id;
    for (std::size_t k = 0; k < 3; ++k) {
      out.surface[(SURFACE_X + k) * count + i] = static_cast<float>(point[static_cast<int>(k)]);
      out.surface[(SURFACE_NORMAL_X + k) * count + i] = static_cast<float>(normal[static_cast<int>(k)]);
    }
    out.surface[SURFACE_RADIUS * count + i] = static_cast<float>(radius);
  }
  return out;
}

}  // namespace hybrid::testing
