// Where everything in the room stands. Positions are shares of the room's size plus a little of the seed,
// chosen so that nothing touches for any seed and the main view sees recess, leaf, columns and both windows.
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/random.hpp"
#include "geometry/solids.hpp"
#include "room/room.hpp"

namespace synth {
namespace {

struct Furnisher {
  World& room;
  Random& random;

  double vary(double centre, double spread) { return random.uniform(centre - spread, centre + spread); }

  void box(const std::string& name, Material material, double x, double y, const Vec3& size, double yaw_rad,
           double bottom_m = -kSunk) {
    const std::size_t first = room.mesh.vertices.size();
    add_box(room.mesh, name, material, {x, y, bottom_m + size.z() / 2}, size, yaw_rad);
    note_clutter(room, name, "box", first);
  }

  void door_leaf(const Recess& door) {
    // Hung on the east jamb; 90 degrees is square to the wall.
    const double angle = vary(88, 12) * kDegree;
    const double width = door.high_m - door.low_m - 0.03;
    const Vec3 along(-std::cos(angle), -std::sin(angle), 0);
    const Vec3 hinge(door.high_m + 0.01, room.size.y() - 0.03, 0);
    const Vec3 middle = hinge + along * (width / 2);
    const std::size_t first = room.mesh.vertices.size();
    add_box(room.mesh, "door-leaf", Material::door, {middle.x(), middle.y(), door.top_m / 2},
            {width, 0.04, door.top_m - 0.04}, std::atan2(-along.y(), -along.x()));
    note_clutter(room, "door-leaf", "box", first);
  }

  void column(const std::string& name, double x, double y, double radius_m) {
    const std::size_t first = room.mesh.vertices.size();
    add_column(room.mesh, name, Material::stone, {x, y, -kSunk}, radius_m, room.size.z() + 2 * kSunk, 192);
    note_clutter(room, name, "cylinder", first);
  }

  void table(double x, double y, double yaw_rad) {
    const std::size_t first = room.mesh.vertices.size();
    const double length = 1.7, depth = 0.85, height = 0.76, top = 0.045, leg = 0.07, inset = 0.09;
    add_box(room.mesh, "table-top", Material::oak, {x, y, height - top / 2}, {length, depth, top}, yaw_rad);
    const Eigen::Rotation2Dd turn(yaw_rad);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d at = turn * Eigen::Vector2d((k & 1 ? 0.5 : -0.5) * (length - 2 * inset),
                                                        (k & 2 ? 0.5 : -0.5) * (depth - 2 * inset));
      const double low = -kSunk, high = height - top + kSunk;
      add_box(room.mesh, "table-leg-" + std::to_string(k + 1), Material::oak,
              {x + at.x(), y + at.y(), (low + high) / 2}, {leg, leg, high - low}, yaw_rad);
    }
    note_clutter(room, "table", "boxes", first);
    box("parcel", Material::cardboard, x + 0.35 * std::cos(yaw_rad), y + 0.35 * std::sin(yaw_rad),
        {0.42, 0.3, 0.26}, yaw_rad + vary(25, 10) * kDegree, height - kSunk);
  }
};

void add_lights(World& room, const std::vector<Recess>& recesses) {
  const double L = room.size.x(), W = room.size.y(), H = room.size.z();
  for (double share : {0.28, 0.82})
    room.lights.push_back({{share * L, 0.5 * W, H - 0.01}, {0, 0.9, 0}, {0.22, 0, 0}, {44, 40.5, 35}, true});
  for (const Recess& r : recesses) {
    if (!r.name.starts_with("window")) continue;
    const std::array<Vec3, 4> ring = r.ring(room.size);
    const Vec3 half_u = (ring[1] - ring[0]) / 2, half_v = (ring[3] - ring[0]) / 2;
    const Vec3 inwards = half_u.cross(half_v).normalized();
    const Vec3 centre = (ring[0] + ring[2]) / 2 - inwards * (r.depth_m - 0.02);
    room.lights.push_back({centre, half_u * 0.94, half_v * 0.94, {3.2, 3.6, 4.2}, false});
  }
}

}  // namespace

World build_room(const Options& options) {
  Random random(options.seed, purpose::layout);
  World room;
  room.kind = "room";
  room.size = {random.uniform(11.6, 12.4), random.uniform(7.7, 8.3), random.uniform(3.85, 4.15)};
  const double L = room.size.x(), W = room.size.y();
  Furnisher f{room, random};

  const double door = f.vary(0.27 * L, 0.15), north = f.vary(0.66 * L, 0.15), east = f.vary(0.52 * W, 0.15);
  const std::vector<Recess> recesses = {
      {"door-recess", "wall-north", door, door + f.vary(1.0, 0.05), 0.02, f.vary(2.12, 0.04), 0.30,
       Material::painted_wood, Material::corridor},
      {"window-north", "wall-north", north, north + f.vary(1.7, 0.15), f.vary(1.0, 0.05), f.vary(2.75, 0.1),
       0.25, Material::painted_wood, Material::daylight},
      {"window-east", "wall-east", east, east + f.vary(1.9, 0.15), f.vary(0.95, 0.05), f.vary(2.8, 0.1), 0.25,
       Material::painted_wood, Material::daylight}};
  add_shell(room.mesh, room.size, recesses,
            {Material::planks, Material::ceiling_tiles, Material::brick, Material::panelled_plaster,
             Material::wallpaper, Material::tiled_plaster});

  f.door_leaf(recesses[0]);
  f.column("column-south", f.vary(0.45 * L, 0.15), f.vary(0.30 * W, 0.1), f.vary(0.26, 0.03));
  f.column("column-north", f.vary(0.68 * L, 0.1), f.vary(0.62 * W, 0.1), f.vary(0.26, 0.03));
  f.table(f.vary(0.77 * L, 0.1), f.vary(0.24 * W, 0.1), f.vary(6, 6) * kDegree);
  f.box("chest", Material::chest, f.vary(0.72 * L, 0.05), W - 0.62, {1.25, 0.55, 0.62},
        f.vary(7, 4) * kDegree);
  f.box("bookcase", Material::books, 0.42, f.vary(0.66 * W, 0.1), {0.46, 1.5, 1.15}, f.vary(3, 2) * kDegree);
  f.box("crate", Material::crate, f.vary(0.31 * L, 0.1), f.vary(0.6, 0.04), {0.62, 0.62, 0.62},
        f.vary(22, 10) * kDegree);

  const Vec3 radii(f.vary(0.36, 0.02), f.vary(0.36, 0.02), f.vary(0.52, 0.03));
  const std::size_t first = room.mesh.vertices.size();
  add_ellipsoid(room.mesh, "ceramic-egg", Material::glaze,
                {f.vary(0.56 * L, 0.1), f.vary(0.71 * W, 0.1), radii.z() - kSunk}, radii, 192, 96);
  note_clutter(room, "ceramic-egg", "ellipsoid", first);
  weld(room.mesh);
  check_closed(room.mesh, 0);

  room.rug_low = {0.20 * L, 0.30 * W};
  room.rug_high = {0.20 * L + 3.0, 0.30 * W + 2.0};
  add_lights(room, recesses);
  hang_decor(room, recesses);
  for (const Recess& r : recesses) {
    const std::array<Vec3, 4> ring = r.ring(room.size);
    room.openings.push_back({r.name, r.wall, r.depth_m, {ring.begin(), ring.end()}});
  }
  add_box_proxy(room);
  move_faces(room.proxy, options);
  place_viewpoints(room, options);
  return room;
}

}  // namespace synth
