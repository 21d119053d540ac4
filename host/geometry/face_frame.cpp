#include "geometry/face_frame.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid {

FaceFrame face_frame(const PolygonModel& model, const Face& face) {
  FaceFrame frame;
  frame.plane = face_plane(model, face);
  const Vec3& normal = frame.plane.normal;
  constexpr double kHorizontal = 0.999;  // within 2.5 degrees no direction on the face counts as upwards
  if (std::abs(normal.z()) < kHorizontal)
    frame.u = Vec3::UnitZ().cross(normal).normalized();
  else
    frame.u = (Vec3::UnitX() - normal.x() * normal).normalized();
  frame.v = normal.cross(frame.u);
  frame.origin = model.vertices[face.outer[0]];
  frame.origin -= frame.plane.distance(frame.origin) * normal;
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
  for (const Vec2& p : flat_ring(frame, model, face.outer)) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  frame.origin = frame.world(low);
  frame.size = high - low;
  return frame;
}

Ring2 flat_ring(const FaceFrame& frame, const PolygonModel& model, const std::vector<std::uint32_t>& ring) {
  Ring2 flat;
  for (const std::uint32_t vertex : ring) flat.push_back(frame.flat(model.vertices[vertex]));
  return flat;
}

std::vector<Ring2> flat_rings(const FaceFrame& frame, const PolygonModel& model, const Face& face) {
  std::vector<Ring2> rings = {flat_ring(frame, model, face.outer)};
  for (const auto& hole : face.holes) rings.push_back(flat_ring(frame, model, hole));
  return rings;
}

bool on_face(const std::vector<Ring2>& rings, const Vec2& point) {
  return inside(rings[0], point) &&
         std::none_of(rings.begin() + 1, rings.end(), [&](const Ring2& hole) { return inside(hole, point); });
}

}  // namespace hybrid
