#include <cmath>

#include "church/church.hpp"
#include "geometry/shapes.hpp"

namespace synth {
namespace {

struct Walls {
  World& world;
  const Plan& plan;

  void side(const std::string& name, double sign) {
    // Seen from outside; the drawing's x is y (right wall) or -y (left wall).
    const Frame frame{{sign * plan.outer_half(), 0, 0}, sign * Vec3::UnitY(), Vec3::UnitZ()};
    const auto x = [&](double y) { return sign * y; };
    Slab wall{name, frame, {}, plan.wall, Material::rubble, Material::limewash, Material::ashlar, {}};
    const double from = plan.wall, to = plan.wall + plan.length;
    wall.outline = rectangle(std::min(x(from), x(to)), 0, std::max(x(from), x(to)), plan.eaves);
    for (int bay = 0; bay < plan.bays; ++bay) {
      const double middle = x(plan.inner_y((bay + 0.5) * plan.bay()));
      const std::string window = name + "-window-" + std::to_string(bay + 1);
      wall.holes.push_back({window, plan.window_outline(middle, 0), Material::dressed_stone});
      const Frame pane{frame.at({0, 0}, -0.36), frame.u, frame.v};
      add_slab(world.mesh, {window + "-glass",
                            pane,
                            plan.window_outline(middle, 0.02),
                            0.03,
                            Material::outer_glass,
                            Material::stained_glass,
                            Material::iron,
                            {}});
      // One mullion, in front of the glass.
      const double top = apex(plan.window_half, plan.window_springing, plan.arch_sharpness);
      const Vec3 foot = frame.at({middle, (plan.window_sill + top) / 2}, -0.36);
      add_box(world.mesh, window + "-mullion", Material::dressed_stone, foot,
              {0.16, 0.11, top - plan.window_sill}, 0);
      for (const bool inside : {false, true}) {
        Opening opening{window + (inside ? "-inside" : ""),
                        (inside ? "inner-" : "") + name,
                        inside ? plan.wall - 0.39 : 0.36,
                        {}};
        const Outline ring = plan.window_outline(middle, 0);
        for (const Vec2& p : ring.points) opening.ring.push_back(frame.at(p, inside ? -plan.wall : 0));
        if (inside) std::reverse(opening.ring.begin(), opening.ring.end());
        world.openings.push_back(opening);
      }
    }
    add_slab(world.mesh, wall);
    buttresses(name, sign);
  }

  void buttresses(const std::string& name, double sign) {
    // Profile outwards from the wall: two steps, each with a slope.
    const auto profile = [&](double z) {
      Outline ring;
      for (const Vec2& p : {Vec2(-0.05, -0.05), Vec2(1.0, -0.05), Vec2(1.0, 0.48 * z), Vec2(0.62, 0.58 * z),
                            Vec2(0.62, 0.8 * z), Vec2(-0.05, 1.02 * z)})
        ring.line_to(p);
      return ring;
    };
    for (int k = 0; k <= plan.bays; ++k) {
      const double middle = std::min(plan.outer_length() - 0.6, std::max(0.95, plan.inner_y(k * plan.bay())));
      const Vec3 u = sign * Vec3::UnitX();
      const Vec3 normal = u.cross(Vec3::UnitZ());
      const Vec3 origin(sign * plan.outer_half(), middle, 0);
      add_slab(world.mesh, {name + "-buttress-" + std::to_string(k + 1),
                            {origin + 0.32 * normal, u, Vec3::UnitZ()},
                            profile(0.86 * plan.eaves),
                            0.64,
                            Material::ashlar,
                            Material::ashlar,
                            Material::dressed_stone,
                            {}});
    }
  }

  void front_buttresses() {
    for (const double sign : {-1.0, 1.0}) {
      Outline ring;  // outwards = -y, drawn to the right
      for (const Vec2& p : {Vec2(-0.05, -0.05), Vec2(0.85, -0.05), Vec2(0.85, 2.9), Vec2(0.5, 3.5),
                            Vec2(0.5, 4.8), Vec2(-0.05, 5.6)})
        ring.line_to(p);
      const Vec3 u = -Vec3::UnitY(), normal = u.cross(Vec3::UnitZ());
      const Vec3 origin(sign * 2.75, 0, 0);
      add_slab(world.mesh, {sign < 0 ? "front-buttress-left" : "front-buttress-right",
                            {origin + 0.3 * normal, u, Vec3::UnitZ()},
                            ring,
                            0.6,
                            Material::ashlar,
                            Material::ashlar,
                            Material::dressed_stone,
                            {}});
    }
  }

  void end_wall() {
    // Seen from inside (towards -y): the front is the inner face.
    const Frame frame{{0, plan.wall + plan.length, 0}, Vec3::UnitX(), Vec3::UnitZ()};
    Outline gable;
    const double half = plan.outer_half();
    for (const Vec2& p : {Vec2(-half, 0), Vec2(half, 0), Vec2(half, plan.eaves + 0.35),
                          Vec2(0, plan.ridge + 0.35), Vec2(-half, plan.eaves + 0.35)})
      gable.line_to(p);
    const Outline window = arched(0, 1.35, 2.9, 5.0, 0.85);
    Slab wall{"end-wall",       frame, gable, plan.wall, Material::limewash, Material::rubble,
              Material::ashlar, {}};
    wall.holes = {{"east-window", window, Material::dressed_stone}};
    add_slab(world.mesh, wall);
    const Frame pane{frame.at({0, 0}, -0.46), frame.u, frame.v};
    add_slab(world.mesh, {"east-glass",
                          pane,
                          grown(window, 0.02),
                          0.03,
                          Material::stained_glass,
                          Material::outer_glass,
                          Material::iron,
                          {}});
    Slab tracery{"east-tracery",          {frame.at({0, 0}, -0.36), frame.u, frame.v},
                 grown(window, 0.01),     0.14,
                 Material::dressed_stone, Material::dressed_stone,
                 Material::dressed_stone, {}};
    const double top = apex(0.42, 4.75, 0.9);
    for (int k = -1; k <= 1; ++k)
      tracery.holes.push_back(
          {"east-light-" + std::to_string(k + 2), arched(0.87 * k, 0.36, 3.0, k == 0 ? 5.1 : 4.6, 0.9)});
    tracery.holes.push_back({"east-eye", circle({0, top + 0.95}, 0.36)});
    add_slab(world.mesh, tracery);
    Opening opening{"east-window", "inner-end", 0.36, {}};
    for (const Vec2& p : window.points) opening.ring.push_back(frame.at(p));
    world.openings.push_back(opening);
    // Straight through the wall.
    Opening outside{"east-window-outside", "back", plan.wall - 0.49, {}};
    for (const Vec2& p : window.points) outside.ring.push_back(frame.at(p, -plan.wall));
    std::reverse(outside.ring.begin(), outside.ring.end());
    world.openings.push_back(outside);
  }

  void roof() {
    const double half = plan.outer_half(), over = 0.45, thick = 0.22;
    const double slope = plan.slope(), length = plan.length + 0.1;
    const double run = std::hypot(half + over, slope * (half + over));
    for (const double sign : {-1.0, 1.0}) {
      // Drawn along the ridge (x) and up the slope (y), from the eave.
      const Vec3 up = Vec3(-sign, 0, slope).normalized();
      const Vec3 along = sign * Vec3::UnitY();
      const double y = sign > 0 ? plan.wall - 0.05 : plan.wall + plan.length + 0.05;
      const Vec3 eave(sign * (half + over), y, plan.eaves - slope * over + 0.04);
      add_slab(world.mesh, {sign < 0 ? "roof-left" : "roof-right",
                            {eave, along, up},
                            rectangle(0, 0, length, run - 0.02),
                            thick,
                            Material::slate,
                            Material::timber,
                            Material::timber,
                            {}});
    }
    add_tube(world.mesh, "ridge-tiles", Material::slate,
             {{0, plan.wall, plan.ridge + 0.02}, {0, plan.wall + plan.length, plan.ridge + 0.02}}, false,
             0.12, 12);
  }

  void floor() {
    const double door = plan.portal_depth[0] + plan.portal_depth[1];
    Slab nave{"floor",
              {{0, 0, plan.floor}, Vec3::UnitX(), Vec3::UnitY()},
              {},
              0.25,
              Material::flagstones,
              Material::flagstones,
              Material::dressed_stone,
              {}};
    nave.outline =
        rectangle(-plan.half_width - 0.02, door, plan.half_width + 0.02, plan.wall + plan.length + 0.02);
    add_slab(world.mesh, nave);
    const double half = plan.portal_half;
    add_box(world.mesh, "step-upper", Material::dressed_stone, {0, door / 2 - 0.3, plan.upper_step - 0.15},
            {2 * half + 0.5, door + 0.7, 0.3}, 0);
    add_box(world.mesh, "step-lower", Material::dressed_stone, {0, -0.5, 0.06}, {2 * half + 1.3, 1.1, 0.16},
            0);
    add_slab(world.mesh, {"churchyard",
                          {{0, 0, 0}, Vec3::UnitX(), Vec3::UnitY()},
                          rectangle(-20, -20, 20, 26),
                          0.3,
                          Material::cobbles,
                          Material::lawn,
                          Material::lawn,
                          {}});
  }
};

}  // namespace

void add_walls_and_roof(World& world, const Plan& plan) {
  Walls walls{world, plan};
  walls.side("right", 1);
  walls.side("left", -1);
  walls.front_buttresses();
  walls.end_wall();
  walls.roof();
  walls.floor();
  // One wall of two solids is one plane.
  for (const char* name : {"right", "left"}) {
    share_planes(world.mesh, "front-side", name);
    share_planes(world.mesh, "front-middle-side", "front-side");
    share_planes(world.mesh, "tympanum-side", "front-side");
    share_planes(world.mesh, "end-wall-side", "front-side");
    share_planes(world.mesh, name, "front-side");
  }
}

}  // namespace synth
