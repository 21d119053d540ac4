#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace synth {

using Vec3 = Eigen::Vector3d;

enum class Material {
  planks,
  ceiling_tiles,
  brick,
  panelled_plaster,
  wallpaper,
  tiled_plaster,
  painted_wood,
  corridor,
  daylight,
  door,
  oak,
  chest,
  books,
  crate,
  cardboard,
  stone,
  glaze,
  ashlar,
  rubble,
  dressed_stone,
  marble,
  limewash,
  vault_plaster,
  timber,
  pew_wood,
  oak_door,
  flagstones,
  chancel_tiles,
  cobbles,
  lawn,
  slate,
  carpet,
  linen,
  iron,
  brass,
  rubber,
  red_paint,
  coat,
  skin,
  foliage,
  notice_board,
  stained_glass,  // a pane's side towards the inside
  outer_glass
};

inline bool is_glass(Material m) {
  return m == Material::stained_glass || m == Material::outer_glass;
}

// free: no equation; normals and texture coordinates come from the vertices.
enum class Shape { plane, cylinder, ellipsoid, free };

// A patch of one material. Planes: normal . x = offset_m, normal towards the free side; texture coordinates
// are metres along u_axis (to the right, seen from the free side) and v_axis (up) from `origin`. Cylinders:
// `origin` on the axis, radii.x() the radius. Ellipsoids: `origin` the centre, radii the half axes.
struct Surface {
  std::string name;
  Material material = Material::planks;
  Shape shape = Shape::plane;
  int plane_id = 0;  // from 1; 0 = curved
  Vec3 origin = Vec3::Zero(), u_axis = Vec3::UnitX(), v_axis = Vec3::UnitY();
  Vec3 centre = Vec3::Zero();  // planes: middle of the rectangle
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;
  Vec3 radii = Vec3::Zero();
  std::string proxy_face;  // empty: the proxy has no face here

  Vec3 smooth_normal(const Vec3& point) const;
};

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from the free side
  std::vector<std::uint32_t> surface_of_triangle;
  std::vector<Surface> surfaces;
  // Parallel to `vertices`, of use on free surfaces only: unit normals, texture coordinates in metres.
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> coordinates;
};

// Merges vertices at the same place. What smooth shading needs apart is lost.
void weld(Mesh& mesh);

// Throws unless every edge of the triangles from `first` on is met by exactly one edge the other way round:
// closed and consistently oriented. Vertices at the same place count as one.
void check_closed(const Mesh& mesh, std::size_t first_triangle);

}  // namespace synth
