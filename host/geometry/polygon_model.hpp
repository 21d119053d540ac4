#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/plane.hpp"

namespace hybrid {

// One planar polygon, counter-clockwise seen from its front side, with optional holes (clockwise).
struct Face {
  std::string name;                               // OBJ group, else "face-<index>"
  std::vector<std::uint32_t> outer;               // vertex indices
  std::vector<std::vector<std::uint32_t>> holes;  // vertex indices
};

// The photogrammetric proxy: polygons of any size in the world frame, metres.
struct PolygonModel {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

struct Triangle {
  std::array<std::uint32_t, 3> vertices{};
  std::uint32_t face = 0;
};

// Newell's plane of the face's outer ring; the normal points to the front side. Throws ErrorKind::input
// naming the face when its area is zero.
Plane face_plane(const PolygonModel& model, const Face& face);
double face_area_m2(const PolygonModel& model, const Face& face);

// Ear clipping of every face (concave ones right, holes bridged), front sides kept. Zero-area faces throw
// ErrorKind::input naming them.
std::vector<Triangle> triangulate(const PolygonModel& model);

// Whether triangulate() takes the model. Rounding differs between frames: a contour polygon that is barely
// simple in the scan's frame need not be in the world's, so ask in the frame that draws it.
bool can_be_triangulated(const PolygonModel& model);

}  // namespace hybrid
