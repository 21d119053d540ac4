#include "stages/proxy_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

void store(const Vec3& value, float* target) {
  for (int a = 0; a < 3; ++a) target[a] = static_cast<float>(value(a));
}

// The face's normal when it is planar.
std::optional<Vec3> common_normal(const PolygonModel& model, const Face& face) {
  const Plane plane = face_plane(model, face);
  double deviation = 0, extent = 0;
  for (std::uint32_t v : face.outer) {
    deviation = std::max(deviation, std::abs(plane.distance(model.vertices[v])));
    extent = std::max(extent, (model.vertices[v] - model.vertices[face.outer[0]]).norm());
  }
  if (deviation > 1e-4 * extent) return std::nullopt;
  return plane.normal;
}

ProxyTriangle record(const PolygonModel& model, const Triangle& triangle, const std::optional<Vec3>& common,
                     const Vec3& origin) {
  const Vec3 a = model.vertices[triangle.vertices[0]] - origin;
  const Vec3 b = model.vertices[triangle.vertices[1]] - origin;
  const Vec3 c = model.vertices[triangle.vertices[2]] - origin;
  const Vec3 normal = common ? *common : Vec3((b - a).cross(c - a).normalized());
  ProxyTriangle out{};
  store(normal, out.normal);
  out.offset = static_cast<float>(normal.dot(a + b + c) / 3);
  store(a, out.a);
  store(b - a, out.ab);
  store(c - a, out.ac);
  out.inverse_ab2 = static_cast<float>(1 / (b - a).squaredNorm());
  out.inverse_bc2 = static_cast<float>(1 / (c - b).squaredNorm());
  out.inverse_ca2 = static_cast<float>(1 / (a - c).squaredNorm());
  store(normal.cross(b - a), out.inward_ab);
  store(normal.cross(c - b), out.inward_bc);
  store(normal.cross(a - c), out.inward_ca);
  out.face = triangle.face;
  return out;
}

}  // namespace

std::vector<ProxyTriangle> proxy_triangles(const PolygonModel& model, const Vec3& origin) {
  if (model.faces.empty())
    fail_input("model: expected at least one face to register to, found none; is it a point cloud?");
  std::vector<std::optional<Vec3>> normals;
  const auto triangles = triangulate(model);
  for (const Face& face : model.faces) normals.push_back(common_normal(model, face));
  std::vector<ProxyTriangle> records;
  records.reserve(triangles.size());
  for (const Triangle& triangle : triangles)
    records.push_back(record(model, triangle, normals[triangle.face], origin));
  return records;
}

}  // namespace hybrid::stages
