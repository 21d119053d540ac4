#include "stages/registration/proxy_triangles.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFloatRounding = 1e-6;  // of what the kernel computes in float, in parts of the coordinates

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
  store(normal.cross(b - a).normalized(), out.inward_ab);
  store(normal.cross(c - b).normalized(), out.inward_bc);
  store(normal.cross(a - c).normalized(), out.inward_ca);
  const double reach =
      std::max({a.norm(), b.norm(), c.norm(), (b - a).norm(), (c - b).norm(), (a - c).norm()});
  out.slack = static_cast<float>(kFloatRounding * reach);
  out.face = triangle.face;
  return out;
}

}  // namespace

ProxyFacets proxy_facets(const PolygonModel& model) {
  if (model.faces.empty())
    fail_input("model: expected at least one face to register to, found none; is it a point cloud?");
  ProxyFacets facets{triangulate(model), {}};
  facets.normals.reserve(model.faces.size());
  for (const Face& face : model.faces) facets.normals.push_back(common_normal(model, face));
  return facets;
}

std::vector<ProxyTriangle> proxy_triangles(const PolygonModel& model, const ProxyFacets& facets,
                                           const Vec3& origin) {
  std::vector<ProxyTriangle> records(facets.triangles.size());
  parallel_for(
      records.size(),
      [&](std::size_t i) {
        const Triangle& triangle = facets.triangles[i];
        records[i] = record(model, triangle, facets.normals[triangle.face], origin);
      },
      kTriangleBatch);
  return records;
}

std::vector<ProxyTriangle> proxy_triangles(const PolygonModel& model, const Vec3& origin) {
  return proxy_triangles(model, proxy_facets(model), origin);
}

}  // namespace hybrid::stages
