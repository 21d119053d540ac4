// Columns with bases and capitals, the arcades above them, the ceilings.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "church/church.hpp"
#include "geometry/shapes.hpp"

namespace synth {
namespace {

constexpr double kPi = std::numbers::pi;

struct Nave {
  World& world;
  const Plan& plan;
  double radius;  // of the columns

  void column(const std::string& name, double x, double y, Material shaft) {
    const std::size_t first = world.mesh.vertices.size();
    const double r = radius, foot = plan.floor, top = plan.springing;
    add_box(world.mesh, name + "-plinth", Material::dressed_stone, {x, y, foot + 0.12},
            {2 * r + 0.30, 2 * r + 0.30, 0.25}, 0);
    std::vector<Vec2> profile = {{0, 0.2}, {r + 0.12, 0.2}};
    for (int k = 0; k <= 8; ++k)  // torus
      profile.push_back(
          {r + 0.05 + 0.08 * std::cos(kPi * (k / 8.0 - 0.5)), 0.33 + 0.08 * std::sin(kPi * (k / 8.0 - 0.5))});
    profile.push_back({r + 0.01, 0.44});
    const double height = top - foot;
    for (int k = 0; k <= 6; ++k) profile.push_back({r - 0.025 * k / 6.0, 0.46 + (height - 0.98) * k / 6.0});
    const double neck = height - 0.52;
    for (int k = 0; k <= 6; ++k)  // astragal
      profile.push_back({r - 0.02 + 0.045 * std::sin(kPi * k / 6.0), neck + 0.09 * k / 6.0});
    for (int k = 0; k <= 10; ++k) {  // bell of the capital
      const double t = k / 10.0;
      profile.push_back({r - 0.02 + 0.20 * t * t, neck + 0.10 + 0.28 * t});
    }
    profile.push_back({0, neck + 0.385});
    add_turned(world.mesh, name, shaft, {x, y, foot}, profile, pieces_of_arc(r, 2 * kPi));
    note_clutter(world, name, "cylinder", first);
    add_box(world.mesh, name + "-abacus", Material::dressed_stone, {x, y, top - 0.065},
            {2 * r + 0.42, 2 * r + 0.42, 0.13 + 2 * kSunk}, 0);
  }

  void arcade(const std::string& name, double sign) {
    const double half = plan.bay() / 2 - radius - 0.04, rise = plan.aisle_ceiling - 0.3 - plan.springing;
    const double sharpness = std::clamp(((rise / half) * (rise / half) + 1) / 4, 0.5, plan.arch_sharpness);
    const double reach = 2 * half * sharpness - half, r = 2 * half * sharpness, top = std::acos(reach / r);
    Slab wall{name,
              {{sign * plan.arcade + plan.arcade_thick / 2, 0, 0}, Vec3::UnitY(), Vec3::UnitZ()},
              {},
              plan.arcade_thick,
              Material::limewash,
              Material::limewash,
              Material::dressed_stone,
              {}};
    wall.outline.line_to({plan.inner_y(0) - 0.02, plan.springing});
    for (int bay = 0; bay < plan.bays; ++bay) {
      const double c = plan.inner_y((bay + 0.5) * plan.bay());
      wall.outline.arc({c + reach, plan.springing}, r, kPi, kPi - top, 2 * bay + 1);
      wall.outline.arc({c - reach, plan.springing}, r, top, 0, sharpness > 0.5 ? 2 * bay + 2 : 2 * bay + 1);
      wall.outline.line_to({c + half, plan.springing});
    }
    wall.outline.line_to({plan.inner_y(plan.length) + 0.02, plan.springing});
    wall.outline.line_to({plan.inner_y(plan.length) + 0.02, plan.vault_springing});
    wall.outline.line_to({plan.inner_y(0) - 0.02, plan.vault_springing});
    add_slab(world.mesh, wall);
    for (int k = 0; k <= plan.bays; ++k)
      column(name + "-column-" + std::to_string(k + 1), sign * plan.arcade, plan.inner_y(k * plan.bay()),
             k == plan.bays - 1 ? Material::marble : Material::stone);
  }

  void aisle_ceiling(const std::string& name, double sign) {
    const double inner = sign * (plan.arcade + plan.arcade_thick / 2 - 0.02),
                 outer = sign * (plan.half_width + 0.02);
    const double from = plan.wall - 0.02, to = plan.wall + plan.length + 0.02;
    add_slab(world.mesh, {name,
                          {{0, 0, plan.aisle_ceiling}, Vec3::UnitX(), -Vec3::UnitY()},
                          rectangle(std::min(inner, outer), -to, std::max(inner, outer), -from),
                          0.1,
                          Material::timber,
                          Material::timber,
                          Material::timber,
                          {}});
    for (int k = 1; k < 2 * plan.bays; ++k)
      add_box(world.mesh, name + "-beam-" + std::to_string(k), Material::pew_wood,
              {(inner + outer) / 2, plan.inner_y(k * plan.bay() / 2), plan.aisle_ceiling - 0.08},
              {std::abs(outer - inner), 0.16, 0.2}, 0);
  }

  void ring(const std::string& name, double low, double high, double y, double thickness, Material material) {
    const Vec2 centre(0, plan.vault_springing);
    Slab slab{name, {{0, y, 0}, Vec3::UnitX(), Vec3::UnitZ()}, {}, thickness, material, material, material,
              {}};
    slab.outline.arc(centre, high, 0, kPi, 1);
    slab.outline.line_to(centre - Vec2(high, 0));
    slab.outline.arc(centre, low, kPi, 0, 2);
    slab.outline.line_to(centre + Vec2(low, 0));
    add_slab(world.mesh, slab);
  }

  void vault() {
    const double r = plan.nave_half();
    ring("vault", r, r + 0.2, plan.wall - 0.02, plan.length + 0.04, Material::vault_plaster);
    for (int k = 1; k < plan.bays; ++k)
      ring("rib-" + std::to_string(k), r - 0.16, r + 0.05, plan.inner_y(k * plan.bay()) - 0.22, 0.44,
           Material::dressed_stone);
  }

  void timber_ceiling() {
    const double half = plan.nave_half(), rise = plan.crown() - plan.vault_springing;
    const double run = std::hypot(half, rise);
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 up = Vec3(-sign * half, 0, rise).normalized();
      const double from = plan.wall - 0.02, to = plan.wall + plan.length + 0.02;
      const Vec3 origin(sign * half, sign > 0 ? to : from, plan.vault_springing);
      add_slab(world.mesh, {sign < 0 ? "ceiling-left" : "ceiling-right",
                            {origin, -sign * Vec3::UnitY(), up},
                            rectangle(0, -0.1, to - from, run),
                            0.08,
                            Material::timber,
                            Material::timber,
                            Material::timber,
                            {}});
    }
    for (int k = 1; k < plan.bays; ++k)
      add_box(world.mesh, "tie-beam-" + std::to_string(k), Material::pew_wood,
              {0, plan.inner_y(k * plan.bay()), plan.vault_springing - 0.14}, {2 * plan.arcade, 0.26, 0.28},
              0);
  }
};

}  // namespace

void add_nave(World& world, const Plan& plan) {
  Nave nave{world, plan, 0.34};
  nave.arcade("arcade-right", 1);
  nave.arcade("arcade-left", -1);
  nave.aisle_ceiling("aisle-ceiling-right", 1);
  nave.aisle_ceiling("aisle-ceiling-left", -1);
  if (plan.vaulted)
    nave.vault();
  else
    nave.timber_ceiling();
}

}  // namespace synth
