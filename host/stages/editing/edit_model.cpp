#include "stages/editing/edit_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "geometry/ring_fault.hpp"

namespace hybrid::stages {
namespace {

// Points on or just beyond the outline, moved inside by the margin, along the bisector at corners.
void pull_inside(const Ring2& outline, double slack_m, Ring2& ring) {
  const double turn = signed_area(outline) > 0 ? 1 : -1;
  for (Vec2& p : ring) {
    if (distance_to_border(outline, p) > (inside(outline, p) ? kHoleMargin_m : slack_m)) continue;
    for (int pass = 0; pass < 2; ++pass)  // two edges meet in a corner
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        const Vec2 along = (b - a).normalized(), inwards = turn * Vec2(-along.y(), along.x());
        const double height = inwards.dot(p - a);
        if (distance_to_segment(p, a, b) > slack_m || height >= 0.999 * kHoleMargin_m) continue;
        p += (kHoleMargin_m - height) * inwards;
      }
  }
}

std::string at(const Vec2& p) {
  return fmt::format("({:.3f}, {:.3f})", p.x(), p.y());
}

void check_ring(const Ring2& ring) {
  if (const std::string fault = ring_fault(ring); !fault.empty()) fail_input("{}", fault);
  constexpr double kLeast_m2 = 1e-6;
  if (std::abs(signed_area(ring)) < kLeast_m2)
    fail_input("expected a polygon of at least {} m2, found {:.1e} m2", kLeast_m2,
               std::abs(signed_area(ring)));
}

void check_place(const FaceFrame& frame, const std::vector<Ring2>& rings, const Face& face,
                 const Ring2& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i)
    if (!inside(rings[0], ring[i]))
      fail_input(
          "vertex {} at {} lies outside face {}, {:.3f} m from its outline; the face's coordinates go from "
          "(0, 0) to ({:.3f}, {:.3f})",
          i, at(ring[i]), face.name, distance_to_border(rings[0], ring[i]), frame.size.x(), frame.size.y());
  if (borders_meet(rings[0], ring))
    fail_input(
        "the hole leaves the outline of face {} between its vertices; give it more vertices or move it",
        face.name);
  for (std::size_t h = 1; h < rings.size(); ++h)
    if (borders_meet(rings[h], ring) || inside(rings[h], ring[0]) || inside(ring, rings[h][0]))
      fail_input("the hole overlaps hole {} of face {}; make one hole of the two", h, face.name);
}

}  // namespace

PolygonModel without_faces(const PolygonModel& model, const std::vector<bool>& removed) {
  PolygonModel edited;
  edited.vertices = model.vertices;
  for (std::size_t i = 0; i < model.faces.size(); ++i)
    if (!removed[i]) edited.faces.push_back(model.faces[i]);
  if (edited.faces.empty()) fail_input("expected a face to remain, found all {} removed", model.faces.size());
  return edited;
}

void cut_hole(PolygonModel& model, std::size_t index, Ring2 ring, double slack_m) {
  Face& face = model.faces[index];
  const FaceFrame frame = face_frame(model, face);
  const auto rings = flat_rings(frame, model, face);
  check_ring(ring);
  pull_inside(rings[0], slack_m, ring);
  check_ring(ring);
  check_place(frame, rings, face, ring);
  if (signed_area(ring) > 0) std::reverse(ring.begin(), ring.end());  // holes run clockwise
  std::vector<std::uint32_t> hole;
  for (const Vec2& p : ring) {
    hole.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(frame.world(p));
  }
  face.holes.push_back(std::move(hole));
}

Ring2 ring_on_face(const FaceFrame& frame, const std::vector<Vec3>& points, double tolerance_m) {
  Ring2 ring;
  for (const Vec3& p : points) {
    if (std::abs(frame.plane.distance(p)) > tolerance_m)
      fail_input(
          "vertex {} at ({:.3f}, {:.3f}, {:.3f}): expected within {} m of the face's plane, found {:.3f} m",
          ring.size(), p.x(), p.y(), p.z(), tolerance_m, std::abs(frame.plane.distance(p)));
    ring.push_back(frame.flat(p));
  }
  return ring;
}

}  // namespace hybrid::stages
