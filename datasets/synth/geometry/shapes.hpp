#pragma once
#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace synth {

// A rectangular recess pushed outwards from one wall of the room; interval in the wall's running coordinate
// (x for north and south, y for east and west) and in z.
struct Recess {
  std::string name;
  std::string wall;  // wall-north | wall-east | wall-south | wall-west
  double low_m = 0, high_m = 0, bottom_m = 0, top_m = 0, depth_m = 0;
  Material jambs = Material::painted_wood, back = Material::painted_wood;

  // Ring on the wall's plane, counter-clockwise seen from the room.
  std::array<Vec3, 4> ring(const Vec3& room_size) const;
};

// All shapes append to `mesh`; planes get the next free id.

// The shell of the room [0, size]: six faces, their recesses cut out and built behind them. Every face is
// divided at the same coordinates, so the shell is closed without T-junctions.
void add_shell(Mesh& mesh, const Vec3& size, const std::vector<Recess>& recesses,
               const std::array<Material, 6>& materials);  // floor, ceiling, north, east, south, west

// A box turned by yaw about the vertical through its centre; five or six of its faces can be seen.
void add_box(Mesh& mesh, const std::string& name, Material material, const Vec3& centre, const Vec3& size,
             double yaw_rad);

void add_column(Mesh& mesh, const std::string& name, Material material, const Vec3& foot, double radius_m,
                double height_m, int sides);

void add_ellipsoid(Mesh& mesh, const std::string& name, Material material, const Vec3& centre,
                   const Vec3& radii, int slices, int stacks);

}  // namespace synth
