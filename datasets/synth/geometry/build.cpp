#include "geometry/build.hpp"

#include <algorithm>

namespace synth {

std::uint32_t add_vertex(Mesh& mesh, const Vec3& p) {
  mesh.vertices.push_back(p.cast<float>());
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
  const auto planes = std::count_if(mesh.surfaces.begin(), mesh.surfaces.end(),
                                    [](const Surface& s) { return s.plane_id > 0; });
  surface.plane_id = static_cast<int>(planes) + 1;
  mesh.surfaces.push_back(surface);
  return static_cast<std::uint32_t>(mesh.surfaces.size() - 1);
}

}  // namespace synth
