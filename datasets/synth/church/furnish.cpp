// What stands in the nave.
#include <cmath>
#include <numbers>

#include "church/church.hpp"
#include "geometry/shapes.hpp"

namespace synth {
namespace {

struct Furniture {
  World& world;
  const Plan& plan;
  Random& random;
  double floor = plan.floor;

  double vary(double centre, double spread) { return random.uniform(centre - spread, centre + spread); }
  double end() const { return plan.wall + plan.length; }

  void box(const std::string& name, Material material, const Vec3& centre, const Vec3& size, double yaw = 0) {
    add_box(world.mesh, name, material, centre, size, yaw);
  }

  void pew(const std::string& name, double x, double y, double width) {
    const std::size_t first = world.mesh.vertices.size();
    const double low = floor - kSunk;
    box(name + "-seat", Material::pew_wood, {x, y, floor + 0.43}, {width, 0.40, 0.04});
    box(name + "-back", Material::pew_wood, {x, y - 0.22, floor + 0.52}, {width, 0.045, 0.84});
    box(name + "-rail", Material::pew_wood, {x, y - 0.24, floor + 0.955}, {width, 0.09, 0.05});
    for (const double side : {-1.0, 1.0})
      box(name + (side < 0 ? "-end-left" : "-end-right"), Material::pew_wood,
          {x + side * (width / 2 + 0.02), y - 0.02, (low + floor + 1.02) / 2},
          {0.06, 0.50, floor + 1.02 - low});
    note_clutter(world, name, "boxes", first);
  }

  void pews() {
    const double aisle = 0.75, outer = plan.arcade - 0.62;
    for (int row = 0; row < plan.pew_rows; ++row) {
      const double y = plan.wall + 2.7 + 1.0 * row;
      for (const double side : {-1.0, 1.0})
        pew("pew-" + std::to_string(2 * row + (side > 0) + 1), side * (aisle + outer) / 2, y + vary(0, 0.01),
            outer - aisle);
    }
  }

  void chancel() {
    const double half = plan.nave_half() - 0.45;
    // Steps with a cloth-covered altar on top.
    for (int k = 0; k < 2; ++k) {
      const double depth = 3.1 - 0.45 * k, top = floor + 0.16 * (k + 1);
      box("chancel-step-" + std::to_string(k + 1), Material::chancel_tiles,
          {0, end() - depth / 2 + kSunk, (top + floor - kSunk) / 2},
          {2 * half - 0.5 * k, depth, top - floor + kSunk});
    }
    const double base = floor + 0.32;
    const std::size_t first = world.mesh.vertices.size();
    box("altar", Material::linen, {0, end() - 1.15, base + 0.5}, {2.0, 0.8, 1.0 + 2 * kSunk});
    note_clutter(world, "altar", "box", first);
    for (const double side : {-1.0, 1.0}) {
      const std::size_t candle = world.mesh.vertices.size();
      const std::string name = side < 0 ? "candlestick-left" : "candlestick-right";
      add_turned(world.mesh, name, Material::brass, {side * 0.75, end() - 1.1, base + 1.0},
                 {{0, 0},
                  {0.11, 0},
                  {0.11, 0.02},
                  {0.03, 0.07},
                  {0.025, 0.18},
                  {0.05, 0.22},
                  {0.025, 0.26},
                  {0.025, 0.42},
                  {0.07, 0.45},
                  {0, 0.45}},
                 32);
      add_turned(world.mesh, name + "-candle", Material::linen, {side * 0.75, end() - 1.1, base + 1.44},
                 {{0, 0}, {0.022, 0}, {0.022, 0.35}, {0, 0.36}}, 16);
      note_clutter(world, name, "turned", candle);
    }
  }

  void pulpit() {
    const std::size_t first = world.mesh.vertices.size();
    const double x = -plan.nave_half() + 0.75, y = end() - 4.1;
    add_turned(world.mesh, "pulpit", Material::pew_wood, {x, y, floor - kSunk},
               {{0, 0},
                {0.34, 0},
                {0.34, 0.08},
                {0.16, 0.16},
                {0.16, 0.85},
                {0.5, 1.1},
                {0.5, 2.0},
                {0.56, 2.03},
                {0.56, 2.09},
                {0.46, 2.09},
                {0.46, 1.2},
                {0, 1.2}},
               40);
    note_clutter(world, "pulpit", "turned", first);
  }

  void font() {
    const std::size_t first = world.mesh.vertices.size();
    add_turned(world.mesh, "font", Material::marble,
               {-plan.arcade - 1.2 + 0.1, plan.wall + 1.5, floor - kSunk},
               {{0, 0},
                {0.4, 0},
                {0.4, 0.1},
                {0.18, 0.2},
                {0.16, 0.6},
                {0.42, 0.8},
                {0.46, 1.0},
                {0.40, 1.0},
                {0.3, 0.88},
                {0, 0.86}},
               40);
    note_clutter(world, "font", "turned", first);
  }

  void chest() {
    const std::size_t first = world.mesh.vertices.size();
    box("chest", Material::chest, {plan.half_width - 0.5, plan.wall + 1.3, floor + 0.3},
        {0.6, 1.2, 0.6 + 2 * kSunk}, vary(0, 0.05));
    note_clutter(world, "chest", "box", first);
  }
};

}  // namespace

void add_person(World& world, const std::string& name, const Vec3& foot, double height_m, double turn_rad) {
  const std::size_t first = world.mesh.vertices.size();
  const double body = 0.86 * height_m;
  const Vec3 radii(0.25, 0.19, body / 2);
  add_ellipsoid(world.mesh, name + "-coat", Material::coat, foot + Vec3(0, 0, body / 2 - kSunk), radii, 40,
                28);
  add_ellipsoid(world.mesh, name + "-head", Material::skin,
                foot + Vec3(0.02 * std::cos(turn_rad), 0.02 * std::sin(turn_rad), height_m - 0.13),
                {0.095, 0.105, 0.13}, 28, 20);
  note_clutter(world, name, "ellipsoid", first);
}

void furnish(World& world, const Plan& plan, Random& random) {
  Furniture f{world, plan, random};
  f.pews();
  f.chancel();
  f.pulpit();
  f.font();
  f.chest();
  add_person(world, "visitor", {f.vary(1.35, 0.1), f.end() - 3.45, plan.floor}, f.vary(1.72, 0.08), 0);
  add_person(world, "reader",
             {plan.arcade + f.vary(1.3, 0.2), f.vary(plan.wall + 0.6 * plan.length, 0.8), plan.floor},
             f.vary(1.68, 0.08), 1);
}

void add_churchyard(World& world, Random& random) {
  const auto vary = [&](double centre, double spread) {
    return random.uniform(centre - spread, centre + spread);
  };
  // A notice board on two posts.
  std::size_t first = world.mesh.vertices.size();
  const Vec3 board(vary(-5.2, 0.15), vary(-3.4, 0.2), 0);
  const double yaw = vary(0.3, 0.08);
  const Vec3 along(std::cos(yaw), std::sin(yaw), 0);
  for (const double side : {-0.62, 0.62})
    add_box(world.mesh, side < 0 ? "notice-post-left" : "notice-post-right", Material::pew_wood,
            board + side * along + Vec3(0, 0, 0.99), {0.09, 0.09, 2.0}, yaw);
  add_box(world.mesh, "notice-board", Material::notice_board, board + Vec3(0, 0, 1.42), {1.15, 0.06, 0.95},
          yaw);
  note_clutter(world, "notice-board", "boxes", first);

  // A bicycle leaning at the wall.
  first = world.mesh.vertices.size();
  const Vec3 hub(vary(4.0, 0.15), -0.34, 0.34), lean = Vec3(0, 0.24, 0.97).normalized();
  const auto at = [&](double x, double z) -> Vec3 { return hub + Vec3(x, 0, 0) + (z - 0.0) * lean; };
  for (const double x : {0.0, 1.02}) {
    std::vector<Vec3> rim, tyre;
    for (int k = 0; k < 40; ++k) {
      const double a = 2 * std::numbers::pi * k / 40;
      tyre.push_back(at(x + 0.33 * std::cos(a), 0.33 * std::sin(a)));
    }
    const std::string name = x == 0.0 ? "bicycle-wheel-rear" : "bicycle-wheel-front";
    add_tube(world.mesh, name, Material::rubber, tyre, true, 0.018, 10);
    for (int k = 0; k < 9; ++k) {
      const double a = std::numbers::pi * (k + 0.3) / 9;
      add_tube(
          world.mesh, name + "-spoke-" + std::to_string(k), Material::iron,
          {at(x - 0.32 * std::cos(a), -0.32 * std::sin(a)), at(x + 0.32 * std::cos(a), 0.32 * std::sin(a))},
          false, 0.002, 6);
    }
  }
  const Vec3 crank = at(0.42, -0.05), seat = at(0.28, 0.56), head = at(0.86, 0.52), fork = at(1.02, 0);
  const auto tube = [&](const std::string& name, const Vec3& a, const Vec3& b, double r, Material material) {
    add_tube(world.mesh, "bicycle-" + name, material, {a, b}, false, r, 12);
  };
  tube("seat-tube", crank, seat, 0.016, Material::red_paint);
  tube("down-tube", crank, head, 0.018, Material::red_paint);
  tube("top-tube", at(0.29, 0.5), at(0.85, 0.54), 0.015, Material::red_paint);
  tube("chain-stay", hub, crank, 0.011, Material::red_paint);
  tube("seat-stay", hub, at(0.29, 0.5), 0.010, Material::red_paint);
  tube("fork", fork, at(0.83, 0.66), 0.014, Material::red_paint);
  tube("bar", at(0.80, 0.70) + Vec3(0, -0.26, 0.06), at(0.80, 0.70) + Vec3(0, 0.10, -0.02), 0.013,
       Material::iron);
  add_ellipsoid(world.mesh, "bicycle-saddle", Material::rubber, at(0.27, 0.62), {0.13, 0.07, 0.035}, 24, 12);
  note_clutter(world, "bicycle", "tubes", first);

  first = world.mesh.vertices.size();
  add_box(world.mesh, "bench-seat", Material::pew_wood, {vary(-4.1, 0.1), -0.55, 0.45}, {1.3, 0.4, 0.06}, 0);
  for (const double side : {-0.5, 0.5})
    add_box(world.mesh, side < 0 ? "bench-leg-left" : "bench-leg-right", Material::dressed_stone,
            {-4.1 + side, -0.55, 0.21}, {0.12, 0.36, 0.43}, 0);
  note_clutter(world, "bench", "boxes", first);
  add_person(world, "passer-by", {vary(3.4, 0.2), vary(-3.0, 0.3), 0}, vary(1.75, 0.08), 2);
  add_person(world, "waiting", {vary(-2.3, 0.2), vary(-1.7, 0.2), 0}, vary(1.63, 0.08), 1);
  for (const double side : {-1.0, 1.0}) {
    const std::string name = side < 0 ? "cypress-left" : "cypress-right";
    first = world.mesh.vertices.size();
    add_ellipsoid(world.mesh, name, Material::foliage, {side * vary(11.5, 0.8), vary(5, 2), vary(4.3, 0.5)},
                  {1.2, 1.2, 4.5}, 48, 40);
    note_clutter(world, name, "ellipsoid", first);
    add_box(world.mesh, side < 0 ? "yard-wall-left" : "yard-wall-right", Material::rubble,
            {side * 16.5, 0, 0.6}, {0.5, 36, 1.3}, 0);
  }
}

}  // namespace synth
