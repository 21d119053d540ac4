#include <fmt/format.h>
#include <algorithm>

#include "geometry/build.hpp"
#include "geometry/solids.hpp"

namespace synth {
namespace {

struct SlabBuilder {
  Mesh& mesh;
  const Slab& slab;

  // Front (height 0) or back (height -thickness) with the holes left out.
  void face(bool front) {
    const Frame& f = slab.frame;
    const double height = front ? 0 : -slab.thickness_m;
    Vec2 low = slab.outline.points[0], high = low;
    for (const Vec2& p : slab.outline.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    // Texture coordinates run to the right seen from the free side: on the back from the other end.
    const std::uint32_t s =
        front ? add_plane(mesh, slab.name, slab.front, f.at(low, height), f.u, f.v)
              : add_plane(mesh, slab.name + "-back", slab.back, f.at({high.x(), low.y()}, height), -f.u, f.v);
    mesh.surfaces[s].centre = f.at((low + high) / 2, height);
    std::vector<std::vector<Vec2>> holes;
    for (const Hole& hole : slab.holes) holes.push_back(hole.outline.points);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec2& p : slab.outline.points) add_vertex(mesh, f.at(p, height));
    for (const auto& hole : holes)
      for (const Vec2& p : hole) add_vertex(mesh, f.at(p, height));
    for (const auto& [a, b, c] : triangulate(slab.outline.points, holes)) {
      if (front)
        add_triangle(mesh, s, first + a, first + b, first + c);
      else
        add_triangle(mesh, s, first + a, first + c, first + b);
    }
  }

  void quad(std::uint32_t s, const std::array<Vec3, 4>& corner, const std::array<Vec3, 2>& normals,
            const std::array<double, 2>& run) {
    std::array<std::uint32_t, 4> v{};
    for (std::size_t k = 0; k < 4; ++k) {
      const bool second = k == 1 || k == 2;
      v[k] = add_vertex(mesh, corner[k], normals[second], {run[second], k >= 2 ? slab.thickness_m : 0.0});
    }
    add_triangle(mesh, s, v[0], v[1], v[2]);
    add_triangle(mesh, s, v[0], v[2], v[3]);
  }

  // The sides along a ring; `inwards`: of a hole. Corners are the same points as the faces'.
  void sides(const std::string& name, const Outline& ring, Material material, bool inwards) {
    const Frame& f = slab.frame;
    const std::size_t n = ring.points.size();
    const std::vector<Vec2> outwards = mitres(ring.points, true);
    int number = 0;
    std::size_t start = 0;  // not inside an arc, not within a straight run
    while (start < n && ring.curve[start] != 0 && ring.curve[start] == ring.curve[(start + n - 1) % n])
      ++start;
    if (start == n) start = 0;
    std::uint32_t s = 0;
    double run = 0;
    for (std::size_t step = 0; step < n; ++step) {
      const std::size_t k = (start + step) % n, next = (k + 1) % n;
      const Vec2 &a = ring.points[k], &b = ring.points[next];
      const Vec2 along = (b - a).normalized();
      const double sign = inwards ? -1 : 1;
      const int arc = ring.curve[k], before = ring.curve[(k + n - 1) % n];
      if (step == 0 || arc == 0 || arc != before) {
        const std::string label = fmt::format("{}-side-{}", name, ++number);
        run = 0;
        if (arc > 0) {
          s = add_free_surface(mesh, label, material);
        } else {
          Vec3 right = sign * -f.normal(), up = along.x() * f.u + along.y() * f.v;
          if (up.z() < -0.5) {
            right = -right;
            up = -up;
          }
          const Vec3 centre = f.at((a + b) / 2, -slab.thickness_m / 2);
          s = add_plane(mesh, label, material,
                        centre - slab.thickness_m / 2 * right - (b - a).norm() / 2 * up, right, up);
          mesh.surfaces[s].centre = centre;
        }
      }
      const auto smooth = [&](std::size_t corner) {
        const std::size_t previous = (corner + n - 1) % n;
        const bool same = arc > 0 && ring.curve[previous] == arc && ring.curve[corner] == arc;
        const Vec2 out = same ? outwards[corner].normalized() : Vec2(along.y(), -along.x());
        return Vec3(sign * (out.x() * f.u + out.y() * f.v));
      };
      const double length = (b - a).norm();
      const double deep = -slab.thickness_m;
      quad(s, {f.at(b), f.at(a), f.at(a, deep), f.at(b, deep)}, {smooth(next), smooth(k)},
           {run + length, run});
      if (inwards)
        for (std::size_t t = mesh.triangles.size() - 2; t < mesh.triangles.size(); ++t)
          std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      run += length;
    }
  }
};

}  // namespace

void add_slab(Mesh& mesh, const Slab& slab) {
  const std::size_t first = mesh.triangles.size();
  SlabBuilder builder{mesh, slab};
  builder.face(true);
  builder.face(false);
  builder.sides(slab.name, slab.outline, slab.sides, false);
  for (const Hole& hole : slab.holes) builder.sides(hole.name, hole.outline, hole.sides, true);
  check_closed(mesh, first);
}

void share_planes(Mesh& mesh, const std::string& prefix, const std::string& other_prefix) {
  for (Surface& a : mesh.surfaces) {
    if (a.plane_id == 0 || !a.name.starts_with(prefix)) continue;
    for (const Surface& b : mesh.surfaces)
      if (b.plane_id > 0 && b.plane_id < a.plane_id && b.name.starts_with(other_prefix) &&
          (a.normal - b.normal).norm() < 1e-9 && std::abs(a.offset_m - b.offset_m) < 1e-9)
        a.plane_id = b.plane_id;
  }
}

}  // namespace synth
