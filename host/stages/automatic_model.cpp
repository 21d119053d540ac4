#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "stages/automatic_scene.hpp"

namespace hybrid::stages {
namespace {

// Faces of one plane: normals within 1 degree, 2 cm apart at the smaller one's middle.
constexpr double kSameNormal = 0.99985, kSameOffset_m = 0.02;

void check_vertices(const PolygonModel& model) {
  if (model.faces.empty())
    fail_input("model: expected at least one face to register to, found none; is it a point cloud?");
  for (const Face& face : model.faces) {
    const auto check = [&](const std::vector<std::uint32_t>& ring) {
      for (const std::uint32_t v : ring)
        if (v >= model.vertices.size() || !model.vertices[v].allFinite())
          fail_input("model: face {}: vertex {}: expected finite coordinates, found none; repair the model",
                     face.name, v);
    };
    check(face.outer);
    for (const auto& hole : face.holes) check(hole);
  }
}

FaceShape shape_of(const PolygonModel& model, std::uint32_t index) {
  const Face& face = model.faces[index];
  FaceShape shape;
  shape.plane = face_plane(model, face);
  shape.area_m2 = face_area_m2(model, face);
  shape.face = index;
  shape.origin = model.vertices[face.outer[0]];
  Eigen::Index least = 0;
  shape.plane.normal.cwiseAbs().minCoeff(&least);
  shape.u = shape.plane.normal.cross(Vec3::Unit(least)).normalized();
  shape.v = shape.plane.normal.cross(shape.u);
  const auto add = [&](const std::vector<std::uint32_t>& ring) {
    auto& flat = shape.rings.emplace_back();
    for (const std::uint32_t v : ring) {
      const Vec3 p = model.vertices[v] - shape.origin;
      flat.emplace_back(shape.u.dot(p), shape.v.dot(p));
    }
  };
  add(face.outer);
  for (const auto& hole : face.holes) add(hole);
  return shape;
}

Vec3 middle_of(const FaceShape& face) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& p : face.rings[0]) sum += p;
  sum /= static_cast<double>(face.rings[0].size());
  return face.origin + sum.x() * face.u + sum.y() * face.v;
}

}  // namespace

double FaceShape::outside_m(const Vec3& point) const {
  const Vec2 p(u.dot(point - origin), v.dot(point - origin));
  bool inside = false;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const auto& ring : rings)
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        inside = !inside;
      const Vec2 side = b - a;
      const double length2 = side.squaredNorm();
      const double at = length2 > 0 ? std::clamp((p - a).dot(side) / length2, 0.0, 1.0) : 0.0;
      nearest2 = std::min(nearest2, (a + at * side - p).squaredNorm());
    }
  return inside ? 0 : std::sqrt(nearest2);
}

ModelShapes measure_model(const PolygonModel& model) {
  check_vertices(model);
  ModelShapes shapes;
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    shapes.faces.push_back(shape_of(model, f));
    shapes.area_m2 += shapes.faces.back().area_m2;
    for (const std::uint32_t v : model.faces[f].outer) shapes.box.extend(model.vertices[v]);
  }
  std::stable_sort(shapes.faces.begin(), shapes.faces.end(),
                   [](const FaceShape& a, const FaceShape& b) { return a.area_m2 > b.area_m2; });
  shapes.all_faces = shapes.faces.size();
  if (shapes.faces.size() > kMostFaces) shapes.faces.resize(kMostFaces);
  for (const FaceShape& face : shapes.faces) shapes.kept_area_m2 += face.area_m2;
  for (FaceShape& face : shapes.faces) {
    const Vec3 middle = middle_of(face);
    std::size_t k = 0;
    while (k < shapes.planes.size() && !(shapes.planes[k].plane.normal.dot(face.plane.normal) > kSameNormal &&
                                         std::abs(shapes.planes[k].plane.distance(middle)) < kSameOffset_m))
      ++k;
    if (k == shapes.planes.size()) shapes.planes.push_back({face.plane, 0});
    shapes.planes[k].area_m2 += face.area_m2;
    face.plane_index = static_cast<std::uint32_t>(k);
  }
  return shapes;
}

}  // namespace hybrid::stages
