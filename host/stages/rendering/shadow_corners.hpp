#pragma once
#include <optional>
#include <vector>

#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {

// A face with what it lies in. World frame.
struct BoxedPolygon {
  FlatPolygon flat;
  PolygonBox box;
  explicit BoxedPolygon(const SpacePolygon& polygon) : flat(polygon), box(polygon) {}
};

// How far below an upright polygon an upright one goes that it meets at a corner, border at border, in the
// first one's coordinates; 0 where it meets none there.
double goes_down_m(const BoxedPolygon& own, const BoxedPolygon& other);

// The face of a body that stands before a part of a polygon's plane, beside the polygon, and that the plane
// meets at a square corner: a buttress' front passes behind the edge of the wall that it leans on.
struct BodyBeside {
  double corner = 0;  // where they meet, the first of the polygon's coordinates
  const FlatPolygon* face = nullptr;

  // Whether the body hides a place of the plane: seen from `eye` it is behind the face, of which it is
  // before.
  bool hides(const Vec3& place, const Vec3& eye) const;
};

// The nearest one on a side (1: where the first coordinate grows; -1) of an upright polygon, no farther from
// it than the polygon is wide. `faces`: must outlive what is returned.
std::optional<BodyBeside> body_beside(const BoxedPolygon& own, int side,
                                      const std::vector<BoxedPolygon>& faces);

}  // namespace hybrid::stages
