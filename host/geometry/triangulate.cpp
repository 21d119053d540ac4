#include <algorithm>
#include <cmath>
#include <exception>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "geometry/outline.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid {
namespace {

using Ring = std::vector<std::uint32_t>;

// Twice the area times the normal, about the ring's first vertex: far origins cost no digits.
Vec3 newell(const PolygonModel& model, const Ring& ring) {
  Vec3 sum = Vec3::Zero();
  if (ring.empty()) return sum;
  const Vec3 base = model.vertices[ring[0]];
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    sum += (model.vertices[ring[i]] - base).cross(model.vertices[ring[i + 1]] - base);
  return sum;
}

double extent_m(const PolygonModel& model, const Ring& ring) {
  double extent = 0;
  for (std::uint32_t v : ring)
    extent = std::max(extent, (model.vertices[v] - model.vertices[ring[0]]).norm());
  return extent;
}

void check_ring(const PolygonModel& model, const Face& face, const Ring& ring, const char* what) {
  if (ring.size() < 3)
    fail_input("face {}: expected at least 3 vertices in its {}, found {}", face.name, what, ring.size());
  for (std::uint32_t v : ring) {
    if (v >= model.vertices.size())
      fail_input("face {}: vertex index {} in its {}, but the model has {} vertices", face.name, v, what,
                 model.vertices.size());
    if (!model.vertices[v].allFinite())
      fail_input("face {}: vertex {} of its {} is not finite", face.name, v, what);
  }
}

std::vector<Triangle> triangles_of(const PolygonModel& model, std::size_t index) {
  const Face& face = model.faces[index];
  const auto f = static_cast<std::uint32_t>(index);
  check_ring(model, face, face.outer, "outline");
  for (const Ring& hole : face.holes) check_ring(model, face, hole, "hole");
  if (face.outer.size() == 3 && face.holes.empty()) {  // as the general way has it
    face_plane(model, face);                           // throws without an area
    return {{{face.outer[2], face.outer[0], face.outer[1]}, f}};
  }
  std::vector<Triangle> triangles;
  for (const auto& corners : Outline(model, face).triangles()) triangles.push_back({corners, f});
  return triangles;
}

}  // namespace

Plane face_plane(const PolygonModel& model, const Face& face) {
  check_ring(model, face, face.outer, "outline");
  const Vec3 twice_area = newell(model, face.outer);
  const double size = extent_m(model, face.outer);
  // 1e-9 of the square around it: what is left of a metre-sized face in a file with 6 digits is a thousand
  // times more.
  if (!(twice_area.norm() > 1e-9 * size * size))
    fail_input(
        "face {}: expected a polygon with an area, found {} vertices on one point or line; remove the face "
        "from the model",
        face.name, face.outer.size());
  Vec3 centre = Vec3::Zero();
  for (std::uint32_t v : face.outer) centre += (model.vertices[v] - model.vertices[face.outer[0]]);
  centre = model.vertices[face.outer[0]] + centre / static_cast<double>(face.outer.size());
  const Vec3 normal = twice_area.normalized();
  return {normal, normal.dot(centre)};
}

double face_area_m2(const PolygonModel& model, const Face& face) {
  const Vec3 normal = face_plane(model, face).normal;
  double area = 0.5 * newell(model, face.outer).norm();
  for (const Ring& hole : face.holes) {
    check_ring(model, face, hole, "hole");
    area -= 0.5 * std::abs(newell(model, hole).dot(normal));
  }
  return area;
}

std::vector<Triangle> triangulate(const PolygonModel& model) {
  std::vector<std::vector<Triangle>> of_face(model.faces.size());
  std::vector<std::exception_ptr> errors(model.faces.size());
  parallel_for(model.faces.size(), [&](std::size_t f) {
    try {
      of_face[f] = triangles_of(model, f);
    } catch (const Error&) {
      errors[f] = std::current_exception();
    }
  });
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
  std::vector<Triangle> triangles;
  for (const auto& own : of_face) triangles.insert(triangles.end(), own.begin(), own.end());
  return triangles;
}

bool can_be_triangulated(const PolygonModel& model) {
  try {
    triangulate(model);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace hybrid
