#include "stages/rendering/shadow_corners.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

constexpr double kSquareCorner = 0.1;  // cosine between the normals of polygons that meet at a corner
constexpr double kCorner_m = 0.2;      // between them, and of their borders: samples stop short of edges
constexpr double kLeastBehindBody_m = 0.03, kMostBehindBody_m = 0.6;  // of a plane, beside what is seen of it

bool is_square_corner(const FlatPolygon& own, const FlatPolygon& other) {
  return !own.is_level() && !other.is_level() && std::abs(own.normal().dot(other.normal())) <= kSquareCorner;
}

}  // namespace

double goes_down_m(const BoxedPolygon& own, const BoxedPolygon& other) {
  if (!own.box.is_near(other.box, kCorner_m) || !is_square_corner(own.flat, other.flat)) return 0;
  const FlatPolygon &flat = own.flat, &beside = other.flat;
  for (const double x : {flat.low().x(), flat.high().x()}) {
    const Vec3 corner = flat.lifted(Vec2(x, flat.low().y()));
    const Vec2 at = beside.flat(corner);
    const double within = std::min(at.x() - beside.low().x(), beside.high().x() - at.x());
    if (std::abs(within) > kCorner_m || at.y() < beside.low().y() || at.y() > beside.high().y() + kCorner_m ||
        (beside.lifted(at) - corner).norm() > kCorner_m)
      continue;
    const double steep = flat.lifted(Vec2(0, 1)).z() - flat.lifted(Vec2(0, 0)).z();
    return (corner.z() - beside.lifted(Vec2(0, beside.low().y())).z()) / steep;
  }
  return 0;
}

bool BodyBeside::hides(const Vec3& place, const Vec3& eye) const {
  const Vec3 on_face = face->lifted(face->low());
  const double behind = face->normal().dot(on_face - eye), before = face->normal().dot(place - on_face);
  if (behind <= 0 || before < 0) return false;
  const Vec2 through = face->flat(eye + behind / (behind + before) * (place - eye));
  return (through.array() >= face->low().array() - kCorner_m).all() &&
         (through.array() <= face->high().array() + kCorner_m).all();
}

std::optional<BodyBeside> body_beside(const BoxedPolygon& own, int side,
                                      const std::vector<BoxedPolygon>& faces) {
  std::optional<BodyBeside> nearest;
  const FlatPolygon& flat = own.flat;
  if (flat.is_level()) return nearest;
  const Vec2 size = flat.high() - flat.low();
  double most_m = std::min(kMostBehindBody_m, size.x());
  const Vec2 border(side > 0 ? flat.high().x() : flat.low().x(), flat.low().y() + size.y() / 2);
  const Vec3 from = flat.lifted(border), across = side * (flat.lifted(Vec2(1, 0)) - flat.lifted(Vec2(0, 0)));
  for (const BoxedPolygon& other : faces) {
    if (!own.box.is_near(other.box, most_m) || !is_square_corner(flat, other.flat)) continue;
    const FlatPolygon& face = other.flat;
    const double towards = -face.normal().dot(across);
    if (towards <= 0) continue;  // it shows its back
    const double far_m = face.normal().dot(from - face.lifted(face.low())) / towards;
    if (far_m < kLeastBehindBody_m || far_m > most_m) continue;
    const Vec2 met = face.flat(from + far_m * across);
    if (met.x() < face.low().x() - kCorner_m || met.x() > face.high().x() + kCorner_m ||
        met.y() < face.low().y() || met.y() > face.high().y())
      continue;
    most_m = far_m;
    nearest = {border.x() + side * far_m, &face};
  }
  return nearest;
}

}  // namespace hybrid::stages
