#include <algorithm>

#include "geometry/build.hpp"
#include "geometry/shapes.hpp"

namespace synth {
namespace {

// Cuts [low, high] at the given places.
std::vector<double> cut(double low, double high, const std::vector<double>& places) {
  std::vector<double> cuts = {low, high};
  for (double p : places)
    if (p > low && p < high) cuts.push_back(p);
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

// A rectangle of the shell, given by two opposite corners that agree in one coordinate, seen from its free
// side
// (`normal`), divided at the shell's cuts and with the recesses' mouths left out.
struct ShellPainter {
  Mesh& mesh;
  std::array<std::vector<double>, 3> cuts;  // per world axis

  void rectangle(const std::string& name, Material material, const Vec3& low, const Vec3& high,
                 const Vec3& normal, const Vec3& up, const std::vector<const Recess*>& mouths,
                 const std::string& proxy_face = {}) {
    const Vec3 u_axis = up.cross(normal);
    int u = 0, v = 0;
    u_axis.cwiseAbs().maxCoeff(&u);
    up.cwiseAbs().maxCoeff(&v);
    Vec3 origin = low;
    if (u_axis[u] < 0) origin[u] = high[u];
    if (up[v] < 0) origin[v] = high[v];
    const std::uint32_t surface = add_plane(mesh, name, material, origin, u_axis, up);
    mesh.surfaces[surface].proxy_face = proxy_face;
    mesh.surfaces[surface].centre = (low + high) / 2;
    const bool flip = u_axis[u] * up[v] < 0;
    const std::vector<double> us = cut(low[u], high[u], cuts[u]), vs = cut(low[v], high[v], cuts[v]);
    for (std::size_t j = 0; j + 1 < vs.size(); ++j) {
      for (std::size_t i = 0; i + 1 < us.size(); ++i) {
        const bool open = std::any_of(mouths.begin(), mouths.end(), [&](const Recess* m) {
          return us[i] >= m->low_m && us[i + 1] <= m->high_m && vs[j] >= m->bottom_m && vs[j + 1] <= m->top_m;
        });
        if (open) continue;
        std::array<std::uint32_t, 4> corner;
        for (int k = 0; k < 4; ++k) {
          Vec3 p = low;
          p[u] = us[i + (k == 1 || k == 2)];
          p[v] = vs[j + (k >= 2)];
          corner[k] = add_vertex(mesh, p);
        }
        if (flip) std::swap(corner[1], corner[3]);
        add_triangle(mesh, surface, corner[0], corner[1], corner[2]);
        add_triangle(mesh, surface, corner[0], corner[2], corner[3]);
      }
    }
  }
};

struct Wall {
  const char* name;
  Vec3 normal;   // towards the room
  int along;     // the wall's horizontal world axis
  double plane;  // coordinate on the normal's axis
};

std::array<Wall, 4> walls_of(const Vec3& size) {
  return {{{"wall-north", -Vec3::UnitY(), 0, size.y()},
           {"wall-east", -Vec3::UnitX(), 1, size.x()},
           {"wall-south", Vec3::UnitY(), 0, 0.0},
           {"wall-west", Vec3::UnitX(), 1, 0.0}}};
}

void add_recess(ShellPainter& painter, const Wall& wall, const Recess& r) {
  const int across = 1 - wall.along;
  const double behind = wall.plane - wall.normal[across] * r.depth_m;
  const auto [near_m, far_m] = std::minmax(wall.plane, behind);
  const auto corner = [&](double run, double depth, double z) {
    Vec3 p;
    p[wall.along] = run;
    p[across] = depth;
    p.z() = z;
    return p;
  };
  const Vec3 run = Vec3::Unit(wall.along), up = Vec3::UnitZ();
  painter.rectangle(r.name + "-back", r.back, corner(r.low_m, behind, r.bottom_m),
                    corner(r.high_m, behind, r.top_m), wall.normal, up, {});
  painter.rectangle(r.name + "-jamb-low", r.jambs, corner(r.low_m, near_m, r.bottom_m),
                    corner(r.low_m, far_m, r.top_m), run, up, {});
  painter.rectangle(r.name + "-jamb-high", r.jambs, corner(r.high_m, near_m, r.bottom_m),
                    corner(r.high_m, far_m, r.top_m), -run, up, {});
  painter.rectangle(r.name + "-sill", r.jambs, corner(r.low_m, near_m, r.bottom_m),
                    corner(r.high_m, far_m, r.bottom_m), up, wall.normal, {});
  painter.rectangle(r.name + "-head", r.jambs, corner(r.low_m, near_m, r.top_m),
                    corner(r.high_m, far_m, r.top_m), -up, wall.normal, {});
}

}  // namespace

std::array<Vec3, 4> Recess::ring(const Vec3& room_size) const {
  for (const Wall& w : walls_of(room_size)) {
    if (wall != w.name) continue;
    const Vec3 right = Vec3::UnitZ().cross(w.normal);
    const bool reversed = right[w.along] < 0;
    const double first = reversed ? high_m : low_m, second = reversed ? low_m : high_m;
    const auto corner = [&](double run, double z) {
      Vec3 p;
      p[w.along] = run;
      p[1 - w.along] = w.plane;
      p.z() = z;
      return p;
    };
    return {corner(first, bottom_m), corner(second, bottom_m), corner(second, top_m), corner(first, top_m)};
  }
  return {};
}

void add_shell(Mesh& mesh, const Vec3& size, const std::vector<Recess>& recesses,
               const std::array<Material, 6>& materials) {
  const std::array<Wall, 4> walls = walls_of(size);
  ShellPainter painter{mesh, {}};
  for (const Recess& r : recesses) {
    const int along = (r.wall == "wall-north" || r.wall == "wall-south") ? 0 : 1;
    for (double place : {r.low_m, r.high_m}) painter.cuts[along].push_back(place);
    for (double place : {r.bottom_m, r.top_m}) painter.cuts[2].push_back(place);
  }
  painter.rectangle("floor", materials[0], Vec3::Zero(), {size.x(), size.y(), 0}, Vec3::UnitZ(),
                    Vec3::UnitY(), {}, "floor");
  painter.rectangle("ceiling", materials[1], {0, 0, size.z()}, size, -Vec3::UnitZ(), Vec3::UnitY(), {},
                    "ceiling");
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const Wall& wall = walls[k];
    std::vector<const Recess*> mouths;
    for (const Recess& r : recesses)
      if (r.wall == wall.name) mouths.push_back(&r);
    Vec3 low = Vec3::Zero(), high = size;
    low[1 - wall.along] = high[1 - wall.along] = wall.plane;
    painter.rectangle(wall.name, materials[2 + k], low, high, wall.normal, Vec3::UnitZ(), mouths, wall.name);
  }
  for (const Recess& r : recesses)
    for (const Wall& wall : walls)
      if (r.wall == wall.name) add_recess(painter, wall, r);
}

}  // namespace synth
