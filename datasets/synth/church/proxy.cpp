// What a person would block out: outside and inside as polygons, no recesses, mouldings, columns or pews; a
// barrel vault is left out, the curved end of a wall becomes a polygon.
#include <algorithm>

#include "church/church.hpp"

namespace synth {
namespace {

using Ring = std::vector<std::uint32_t>;

// Faces may lie in one plane: the surface's middle tells which it belongs to.
bool covers(const Proxy& proxy, const ProxyFace& face, const Vec3& middle) {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  for (std::uint32_t v : face.ring) {
    low = low.cwiseMin(proxy.vertices[v].position);
    high = high.cwiseMax(proxy.vertices[v].position);
  }
  return (middle - low).minCoeff() > -0.5 && (high - middle).minCoeff() > -0.5;
}

void name_faces(World& world) {
  for (Surface& surface : world.mesh.surfaces)
    for (const ProxyFace& face : world.proxy.faces)
      if (surface.plane_id > 0 && (surface.normal - face.normal).norm() < 1e-6 &&
          std::abs(surface.offset_m - face.offset_m) < 1e-6 && covers(world.proxy, face, surface.centre))
        surface.proxy_face = face.name;
}

}  // namespace

void add_church_proxy(World& world, const Plan& plan) {
  Proxy& proxy = world.proxy;
  const double half = plan.outer_half(), deep = plan.outer_length(), rise = 0.35;
  const auto add = [&](double x, double y, double z, const Vec3& free = Vec3::Zero()) {
    return proxy.add_vertex({x, y, z}, free);
  };
  const auto gable = [&](double y, double towards) {
    return Ring{add(-half, y, 0, {1, towards, 1}), add(half, y, 0, {-1, towards, 1}),
                add(half, y, plan.eaves + rise, {-1, towards, -1}),
                add(0, y, plan.ridge + rise, {0, towards, -2}),
                add(-half, y, plan.eaves + rise, {1, towards, -1})};
  };
  const Ring front = gable(0, -1), back = gable(deep, 1);
  proxy.add_face("front", front);
  proxy.add_face("back", {back[1], back[0], back[4], back[3], back[2]});
  proxy.add_face("right", {front[1], back[1], add(half, deep, plan.eaves), add(half, 0, plan.eaves)});
  proxy.add_face("left", {back[0], front[0], add(-half, 0, plan.eaves), add(-half, deep, plan.eaves)});
  const double over = 0.45, lift = 0.04;
  for (const double sign : {-1.0, 1.0}) {
    const double x = sign * (half + over), z = plan.eaves - plan.slope() * over + lift,
                 top = plan.ridge + lift;
    const double y = plan.wall;
    Ring roof = {add(x, y, z), add(x, deep - y, z), add(0, deep - y, top), add(0, y, top)};
    if (sign < 0) std::reverse(roof.begin(), roof.end());
    proxy.add_face(sign < 0 ? "roof-left" : "roof-right", roof);
  }
  proxy.add_face("churchyard", {add(-20, -20, 0), add(20, -20, 0), add(20, 26, 0), add(-20, 26, 0)});

  // Inside: faces look into the nave.
  const double w = plan.half_width, from = plan.wall, to = plan.wall + plan.length;
  const auto section = [&](double y, double towards) {
    Ring ring;
    Outline outline = plan.cross_section();
    for (std::size_t k = 0; k < outline.points.size(); ++k) {
      const Vec2& p = outline.points[k];
      if (outline.curve[k] > 0 && k % 6 != 4) continue;  // eight chords of the arch
      // What can be told in a scan: the aisles' corners, the ends of the nave ceiling's edges.
      const bool corner =
          std::abs(std::abs(p.x()) - w) < 1e-9 || std::abs(p.y() - plan.vault_springing) < 1e-9;
      const double up = p.y() < 1 ? 1 : -1;
      ring.push_back(
          add(p.x(), y, p.y(), corner ? Vec3(p.x() < 0 ? 1 : -1, towards, up) : Vec3(Vec3::Zero())));
    }
    return ring;
  };
  const Ring west = section(from, 1), east = section(to, -1);
  proxy.add_face("inner-end", east);  // looks along -y: counter-clockwise as drawn
  proxy.add_face("inner-front", Ring(west.rbegin(), west.rend()));
  proxy.add_face("floor", {west[0], west[1], east[1], east[0]});
  proxy.add_face("inner-right", {west[1], west[2], east[2], east[1]});
  proxy.add_face("aisle-ceiling-right", {west[2], west[3], east[3], east[2]});
  const std::size_t last = west.size() - 1;
  proxy.add_face("aisle-ceiling-left", {west[last - 1], west[last], east[last], east[last - 1]});
  proxy.add_face("inner-left", {west[last], west[0], east[0], east[last]});
  if (!plan.vaulted) {
    proxy.add_face("ceiling-right", {west[4], west[5], east[5], east[4]});
    proxy.add_face("ceiling-left", {west[5], west[6], east[6], east[5]});
  }
  name_faces(world);
}

}  // namespace synth
