#include "geometry/build.hpp"

#include <algorithm>

namespace synth {
namespace {

int next_plane_id(const Mesh& mesh) {
  int last = 0;
  for (const Surface& s : mesh.surfaces) last = std::max(last, s.plane_id);
  return last + 1;
}

}  // namespace

std::uint32_t add_vertex(Mesh& mesh, const Vec3& p) {
  return add_vertex(mesh, p, Vec3::Zero(), Eigen::Vector2d::Zero());
}

std::uint32_t add_vertex(Mesh& mesh, const Vec3& p, const Vec3& normal, const Eigen::Vector2d& coordinates) {
  mesh.vertices.push_back(p.cast<float>());
  mesh.normals.push_back(normal.cast<float>());
  mesh.coordinates.push_back(coordinates.cast<float>());
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void add_triangle(Mesh& mesh, std::uint32_t surface, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.push_back({a, b, c});
  mesh.surface_of_triangle.push_back(surface);
}

std::uint32_t add_plane(Mesh& mesh, const std::string& name, Material material, const Vec3& origin,
                        const Vec3& u_axis, const Vec3& v_axis) {
  Surface surface;
  surface.name = name;
  surface.material = material;
  surface.origin = origin;
  surface.u_axis = u_axis;
  surface.v_axis = v_axis;
  surface.normal = u_axis.cross(v_axis);
  surface.offset_m = surface.normal.dot(origin);
  surface.plane_id = next_plane_id(mesh);
  mesh.surfaces.push_back(surface);
  return static_cast<std::uint32_t>(mesh.surfaces.size() - 1);
}

std::uint32_t add_free_surface(Mesh& mesh, const std::string& name, Material material) {
  Surface surface;
  surface.name = name;
  surface.material = material;
  surface.shape = Shape::free;
  mesh.surfaces.push_back(surface);
  return static_cast<std::uint32_t>(mesh.surfaces.size() - 1);
}

std::uint32_t add_flat_free_surface(Mesh& mesh, const std::string& name, Material material, const Vec3& point,
                                    const Vec3& normal) {
  const int id = next_plane_id(mesh);
  const std::uint32_t s = add_free_surface(mesh, name, material);
  Surface& surface = mesh.surfaces[s];
  surface.plane_id = id;
  surface.normal = normal;
  surface.offset_m = normal.dot(point);
  return s;
}

}  // namespace synth
