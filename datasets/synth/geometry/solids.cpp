#include <cmath>
#include <numbers>

#include "geometry/build.hpp"
#include "geometry/shapes.hpp"

namespace synth {

void add_box(Mesh& mesh, const std::string& name, Material material, const Vec3& centre, const Vec3& size,
             double yaw_rad) {
  const Vec3 x(std::cos(yaw_rad), std::sin(yaw_rad), 0), y(-x.y(), x.x(), 0), z = Vec3::UnitZ();
  const Vec3 h = size / 2;
  // Every side computes a corner by the same expression: the same bits, so the sides weld.
  const auto corner = [&](const Vec3& towards) {
    const auto half = [&](const Vec3& axis, double extent) {
      return axis * std::copysign(extent, towards.dot(axis));
    };
    return add_vertex(mesh, centre + half(x, h.x()) + half(y, h.y()) + half(z, h.z()));
  };
  const auto side = [&](const char* which, const Vec3& normal, const Vec3& up, double half_n, double half_u,
                        double half_v) {
    const Vec3 right = up.cross(normal);
    const Vec3 origin = centre + normal * half_n - right * half_u - up * half_v;
    const std::uint32_t s = add_plane(mesh, name + "-" + which, material, origin, right, up);
    mesh.surfaces[s].centre = centre + normal * half_n;
    const std::uint32_t a = corner(normal - right - up), b = corner(normal + right - up),
                        c = corner(normal + right + up), d = corner(normal - right + up);
    add_triangle(mesh, s, a, b, c);
    add_triangle(mesh, s, a, c, d);
  };
  side("front", -y, z, h.y(), h.x(), h.z());
  side("back", y, z, h.y(), h.x(), h.z());
  side("right", x, z, h.x(), h.y(), h.z());
  side("left", -x, z, h.x(), h.y(), h.z());
  side("top", z, y, h.z(), h.x(), h.y());
  side("bottom", -z, y, h.z(), h.x(), h.y());
}

void add_column(Mesh& mesh, const std::string& name, Material material, const Vec3& foot, double radius_m,
                double height_m, int sides) {
  Surface surface;
  surface.name = name;
  surface.material = material;
  surface.shape = Shape::cylinder;
  surface.origin = foot;
  surface.radii = Vec3::Constant(radius_m);
  mesh.surfaces.push_back(surface);
  const auto s = static_cast<std::uint32_t>(mesh.surfaces.size() - 1);
  const std::uint32_t low_centre = add_vertex(mesh, foot);
  const std::uint32_t high_centre = add_vertex(mesh, foot + Vec3(0, 0, height_m));
  const auto rim = [&](int k, double z) {
    const double angle = 2 * std::numbers::pi * (k % sides) / sides;
    return add_vertex(mesh, foot + Vec3(radius_m * std::cos(angle), radius_m * std::sin(angle), z));
  };
  for (int k = 0; k < sides; ++k) {
    const std::uint32_t a = rim(k, 0), b = rim(k + 1, 0), c = rim(k + 1, height_m), d = rim(k, height_m);
    add_triangle(mesh, s, a, b, c);
    add_triangle(mesh, s, a, c, d);
    add_triangle(mesh, s, low_centre, b, a);
    add_triangle(mesh, s, high_centre, d, c);
  }
}

void add_ellipsoid(Mesh& mesh, const std::string& name, Material material, const Vec3& centre,
                   const Vec3& radii, int slices, int stacks) {
  Surface surface;
  surface.name = name;
  surface.material = material;
  surface.shape = Shape::ellipsoid;
  surface.origin = centre;
  surface.radii = radii;
  mesh.surfaces.push_back(surface);
  const auto s = static_cast<std::uint32_t>(mesh.surfaces.size() - 1);
  const auto at = [&](int slice, int stack) {
    if (stack == 0 || stack == stacks)
      return add_vertex(mesh, centre + Vec3(0, 0, stack == 0 ? -radii.z() : radii.z()));
    const double angle = 2 * std::numbers::pi * (slice % slices) / slices;
    const double rise = std::numbers::pi * (static_cast<double>(stack) / stacks - 0.5);
    const Vec3 unit(std::cos(rise) * std::cos(angle), std::cos(rise) * std::sin(angle), std::sin(rise));
    return add_vertex(mesh, centre + radii.cwiseProduct(unit));
  };
  for (int stack = 0; stack < stacks; ++stack) {
    for (int slice = 0; slice < slices; ++slice) {
      const std::uint32_t a = at(slice, stack), b = at(slice + 1, stack), c = at(slice + 1, stack + 1),
                          d = at(slice, stack + 1);
      if (stack > 0) add_triangle(mesh, s, a, b, c);
      if (stack + 1 < stacks) add_triangle(mesh, s, a, c, d);
    }
  }
}

}  // namespace synth
