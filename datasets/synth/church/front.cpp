// The west front: three layers of wall, whose openings narrow from layer to layer: stepped recesses.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "church/church.hpp"
#include "geometry/shapes.hpp"

namespace synth {
namespace {

constexpr double kPane = 0.03;

struct Front {
  World& world;
  const Plan& plan;
  Frame frame{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitZ()};  // normal -y

  Frame behind(double depth) const { return {{0, depth, 0}, frame.u, frame.v}; }

  Outline gable() const {
    const double half = plan.outer_half(), rise = 0.35;
    Outline ring;
    ring.line_to({-half, 0});
    ring.line_to({half, 0});
    ring.line_to({half, plan.eaves + rise});
    ring.line_to({0, plan.ridge + rise});
    ring.line_to({-half, plan.eaves + rise});
    return ring;
  }

  Outline lancet(double side, double grown_by) const {
    return grown(arched(side * plan.lancet_x, 0.42, 1.9, 4.0, 0.95), grown_by);
  }

  Outline rose(double grown_by) const { return circle({0, plan.rose_z}, plan.rose_radius + grown_by); }

  void open(const std::string& name, const Outline& mouth, double depth) {
    Opening opening{name, "front", depth, {}};
    for (const Vec2& p : mouth.points)  // the upper step fills the portal's foot
      opening.ring.push_back(frame.at({p.x(), std::max(p.y(), plan.upper_step)}));
    world.openings.push_back(opening);
  }

  // Height of the nave's ceiling over a place of the inner wall.
  double ceiling(double x) const {
    const double half = plan.nave_half(), side = std::min(std::abs(x), half);
    return plan.vault_springing + (plan.vaulted ? std::sqrt(half * half - side * side)
                                                : (plan.crown() - plan.vault_springing) * (1 - side / half));
  }

  // The same hole seen from the nave: what floor and ceiling leave of its mouth in the inner wall.
  void open_inside(const std::string& name, const Outline& mouth, double depth) {
    Opening opening{name, "inner-front", depth, {}};
    for (const Vec2& p : mouth.points) {
      const double high = std::abs(p.x()) < plan.nave_half() ? ceiling(p.x()) : plan.aisle_ceiling;
      opening.ring.push_back(frame.at({p.x(), std::clamp(p.y(), plan.floor, high)}, -plan.wall));
    }
    std::reverse(opening.ring.begin(), opening.ring.end());
    world.openings.push_back(opening);
  }

  void layers() {
    const double d0 = plan.portal_depth[0], d1 = d0 + plan.portal_depth[1];
    const double half = plan.portal_half;
    const Outline doorway = rectangle(-half + 0.5, 0.2, half - 0.5, plan.portal_springing + 0.05);
    Slab outer{"front", frame, gable(), d0, Material::ashlar, Material::ashlar, Material::ashlar, {}};
    outer.holes = {{"portal", plan.portal_outline(half)},
                   {"rose", rose(0)},
                   {"lancet-left", lancet(-1, 0)},
                   {"lancet-right", lancet(1, 0)}};
    add_slab(world.mesh, outer);
    Slab middle{"front-middle",          behind(d0),       gable(),          d1 - d0,
                Material::dressed_stone, Material::ashlar, Material::ashlar, {}};
    middle.holes = {{"portal-order", plan.portal_outline(half - 0.24)},
                    {"rose-order", rose(-0.16)},
                    {"lancet-left-order", lancet(-1, -0.12)},
                    {"lancet-right-order", lancet(1, -0.12)}};
    add_slab(world.mesh, middle);
    Slab inner{"tympanum",         behind(d1),         gable(),          plan.wall - d1,
               Material::limewash, Material::limewash, Material::ashlar, {}};
    inner.holes = {{"doorway", doorway, Material::dressed_stone},
                   {"rose-inside", rose(-0.05), Material::limewash},
                   {"lancet-left-inside", lancet(-1, 0), Material::limewash},
                   {"lancet-right-inside", lancet(1, 0), Material::limewash}};
    add_slab(world.mesh, inner);
    open("portal", outer.holes[0].outline, d1);
    open("rose", outer.holes[1].outline, d0 + 0.12);
    open("lancet-left", outer.holes[2].outline, d0 + 0.12);
    open("lancet-right", outer.holes[3].outline, d0 + 0.12);
    open_inside("doorway-inside", inner.holes[0].outline, plan.wall - d1 - 0.115);
    for (const std::size_t k : {1, 2, 3})
      open_inside(inner.holes[k].name, inner.holes[k].outline, plan.wall - d0 - 0.12 - kPane);
  }

  void panes() {
    const double at = plan.portal_depth[0] + 0.12;
    const auto pane = [&](const std::string& name, const Outline& outline) {
      add_slab(world.mesh, {name,
                            behind(at),
                            grown(outline, 0.02),
                            kPane,
                            Material::outer_glass,
                            Material::stained_glass,
                            Material::iron,
                            {}});
    };
    pane("rose-glass", rose(-0.16));
    pane("lancet-left-glass", lancet(-1, -0.12));
    pane("lancet-right-glass", lancet(1, -0.12));
  }

  // A disc of stone with round lights, in front of the rose's glass.
  void tracery() {
    const double radius = plan.rose_radius - 0.16;
    Slab disc{"tracery",
              behind(plan.portal_depth[0] - 0.02),
              rose(-0.155),
              0.11,
              Material::dressed_stone,
              Material::dressed_stone,
              Material::dressed_stone,
              {}};
    disc.holes.push_back({"tracery-eye", circle({0, plan.rose_z}, 0.30 * radius)});
    for (int k = 0; k < 8; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / 8;
      disc.holes.push_back(
          {"tracery-light-" + std::to_string(k + 1),
           circle(Vec2(0, plan.rose_z) + 0.66 * radius * Vec2(std::cos(angle), std::sin(angle)),
                  0.22 * radius)});
    }
    add_slab(world.mesh, disc);
  }

  void doors() {
    const double at = plan.portal_depth[0] + plan.portal_depth[1] + 0.08;
    const double half = plan.portal_half - 0.5, top = plan.portal_springing + 0.1;
    const auto leaf = [&](const std::string& name, double hinge, double side, double angle) {
      // Hung at `hinge`, reaching towards the middle when closed, swung inwards by `angle`.
      const Vec3 along(side * -std::cos(angle), std::sin(angle), 0);
      const double width = half - 0.01;
      const Vec3 middle = Vec3(hinge, at, 0) + along * (width / 2);
      const std::size_t first = world.mesh.vertices.size();
      add_box(world.mesh, name, Material::oak_door, {middle.x(), middle.y(), (0.305 + top) / 2},
              {width, 0.07, top - 0.305}, std::atan2(along.y(), along.x()));
      if (angle > 0) note_clutter(world, name, "box", first);
    };
    leaf("door-left", -half, -1, 0);
    leaf("door-right", half, 1, 1.25);
  }

  void mouldings() {
    const std::vector<Vec2> roll = {{0.02, -0.02}, {0.20, -0.02}, {0.20, 0.05},
                                    {0.15, 0.11},  {0.07, 0.11},  {0.02, 0.05}};
    const auto around = [&](const std::string& name, const Outline& mouth, bool closed) {
      std::vector<Vec2> path = mouth.points;
      if (!closed) path = {path.begin() + 2, path.end()};  // from springing to springing
      add_moulding(world.mesh, name, Material::dressed_stone, frame, path, closed, roll);
    };
    Outline portal = plan.portal_outline(plan.portal_half);
    std::vector<Vec2> path = {portal.points[1] + Vec2(0, 0.05)};
    path.insert(path.end(), portal.points.begin() + 2, portal.points.end());
    path.push_back(portal.points[0] + Vec2(0, 0.05));
    add_moulding(world.mesh, "portal-moulding", Material::dressed_stone, frame, path, false, roll);
    // A thin roll in the angle between the two orders.
    const Outline order = plan.portal_outline(plan.portal_half - 0.24);
    std::vector<Vec2> inner = {order.points[1] + Vec2(0, 0.05)};
    inner.insert(inner.end(), order.points.begin() + 2, order.points.end());
    inner.push_back(order.points[0] + Vec2(0, 0.05));
    std::vector<Vec2> shaft;
    for (int k = 0; k < 12; ++k) {
      const double a = 2 * std::numbers::pi * k / 12;
      shaft.push_back({0.12 + 0.075 * std::cos(a), 0.075 + 0.075 * std::sin(a)});
    }
    add_moulding(world.mesh, "portal-shaft", Material::dressed_stone, behind(plan.portal_depth[0]), inner,
                 false, shaft);
    around("rose-moulding", rose(0), true);
    around("lancet-left-moulding", lancet(-1, 0), false);
    around("lancet-right-moulding", lancet(1, 0), false);
    // String course and coping.
    const double half = plan.outer_half();
    Outline course;  // in front of the wall, up
    for (const Vec2& p : {Vec2(-0.02, -0.09), Vec2(0.06, -0.09), Vec2(0.13, -0.05), Vec2(0.13, 0.03),
                          Vec2(0.05, 0.09), Vec2(-0.02, 0.09)})
      course.line_to(p);
    add_slab(world.mesh, {"string-course",
                          {{-half - 0.04, 0, 5.8}, -Vec3::UnitY(), Vec3::UnitZ()},
                          course,
                          2 * half + 0.08,
                          Material::dressed_stone,
                          Material::dressed_stone,
                          Material::dressed_stone,
                          {}});
    const Outline g = gable();
    add_moulding(
        world.mesh, "coping", Material::dressed_stone, frame, {g.points[2], g.points[3], g.points[4]}, false,
        {{-0.04, -plan.wall - 0.08}, {0.17, -plan.wall - 0.08}, {0.22, -0.4}, {0.17, 0.10}, {-0.04, 0.10}});
  }

  void cross() {
    const double z = plan.ridge + 0.5;
    add_box(world.mesh, "cross-upright", Material::dressed_stone, {0, 0.4, z + 0.6}, {0.16, 0.16, 1.3}, 0);
    add_box(world.mesh, "cross-arm", Material::dressed_stone, {0, 0.4, z + 0.8}, {0.75, 0.14, 0.16}, 0);
  }
};

}  // namespace

void add_front(World& world, const Plan& plan) {
  Front front{world, plan};
  front.layers();
  front.panes();
  front.tracery();
  front.doors();
  front.mouldings();
  front.cross();
}

}  // namespace synth
