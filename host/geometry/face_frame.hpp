#pragma once
#include "geometry/flat_ring.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid {

// Coordinates on a proxy face, metres, as seen from its front: u to the right, v up. u is horizontal, so v is
// as near to the vertical as the face allows; on a horizontal face u is the world's x. (0, 0) is the
// lower left corner of the outline's bounding box: no coordinate of the face is negative. Third axis: height
// over the face, towards its front.
struct FaceFrame {
  Plane plane;
  Vec3 origin = Vec3::Zero(), u = Vec3::UnitX(), v = Vec3::UnitY();
  Vec2 size = Vec2::Zero();  // of the outline's bounding box

  Vec2 flat(const Vec3& point) const { return {u.dot(point - origin), v.dot(point - origin)}; }
  Vec3 world(const Vec2& point, double height_m = 0) const {
    return origin + point.x() * u + point.y() * v + height_m * plane.normal;
  }
};

// Throws ErrorKind::input naming a face without an area.
FaceFrame face_frame(const PolygonModel& model, const Face& face);

Ring2 flat_ring(const FaceFrame& frame, const PolygonModel& model, const std::vector<std::uint32_t>& ring);

// The face's rings in its coordinates: outline first, then holes.
std::vector<Ring2> flat_rings(const FaceFrame& frame, const PolygonModel& model, const Face& face);

// Whether a point of the face's plane lies on the face: in the outline and in no hole.
bool on_face(const std::vector<Ring2>& rings, const Vec2& point);

}  // namespace hybrid
