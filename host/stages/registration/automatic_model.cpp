#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "stages/registration/automatic_scene.hpp"

namespace hybrid::stages {
namespace {

// Faces of one plane: normals within 1 degree, 2 cm apart at the smaller one's middle.
constexpr double kSameFaceNormal = 0.99985, kSameFaceOffset_m = 0.02;
constexpr std::size_t kSidesOfChain = 8;
constexpr double kRayRounding_m = 1e-9;  // of where a ray crosses a side

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

// The faces that are kept: of equal ones the first.
std::vector<std::uint32_t> largest_first(const std::vector<double>& areas) {
  std::vector<std::uint32_t> order(areas.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto kept = order.begin() + static_cast<std::ptrdiff_t>(std::min(order.size(), kMostFaces));
  std::partial_sort(order.begin(), kept, order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return areas[a] != areas[b] ? areas[a] > areas[b] : a < b;
  });
  order.erase(kept, order.end());
  return order;
}

FaceShape shape_of(const PolygonModel& model, std::uint32_t index, double area_m2) {
  const Face& face = model.faces[index];
  FaceShape shape;
  shape.plane = face_plane(model, face);
  shape.area_m2 = area_m2;
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
  for (const Vec2& p : shape.rings[0]) shape.box.extend(p);
  for (const auto& hole : face.holes) add(hole);
  for (const auto& ring : shape.rings) {
    const std::size_t begin = shape.path.size(), end = begin + ring.size();
    shape.path.insert(shape.path.end(), ring.begin(), ring.end());
    shape.path.push_back(ring[0]);
    for (std::size_t first = begin; first < end; first += kSidesOfChain) {
      auto& chain =
          shape.chains.emplace_back(FaceShape::Chain{first, std::min(first + kSidesOfChain, end), {}});
      for (std::size_t k = first; k <= chain.last; ++k) chain.box.extend(shape.path[k]);
    }
  }
  return shape;
}

Vec3 middle_of(const FaceShape& face) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& p : face.rings[0]) sum += p;
  sum /= static_cast<double>(face.rings[0].size());
  return face.origin + sum.x() * face.u + sum.y() * face.v;
}

}  // namespace

// By the sides that a ray along x crosses. Of a chain that lies wholly beyond the ray's begin the ends alone
// tell whether the ray crosses it an odd number of times.
bool FaceShape::is_inside(const Vec2& p) const {
  bool inside = false;
  for (const Chain& chain : chains) {
    if (p.y() < chain.box.min().y() || p.y() >= chain.box.max().y() ||
        p.x() > chain.box.max().x() + kRayRounding_m)
      continue;
    if (p.x() < chain.box.min().x() - kRayRounding_m) {
      inside ^= (path[chain.first].y() > p.y()) != (path[chain.last].y() > p.y());
      continue;
    }
    for (std::size_t k = chain.first; k < chain.last; ++k) {
      const Vec2 &a = path[k], &b = path[k + 1];
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        inside = !inside;
    }
  }
  return inside;
}

double FaceShape::outside_rings_m(const Vec2& p, double most_m) const {
  constexpr double kRoundedDown = 1 - 1e-9, kRoundedUp = 1 + 1e-9,
                   kNone = std::numeric_limits<double>::infinity();
  if (is_inside(p)) return 0;
  const double most2 = most_m * most_m * kRoundedUp;
  double nearest2 = most2;
  for (const Chain& chain : chains) {
    if (kRoundedDown * chain.box.squaredExteriorDistance(p) > nearest2) continue;
    for (std::size_t k = chain.first; k < chain.last; ++k) {
      const Vec2 &a = path[k], side = path[k + 1] - a;
      const double length2 = side.squaredNorm();
      const double at = length2 > 0 ? std::clamp((p - a).dot(side) / length2, 0.0, 1.0) : 0.0;
      nearest2 = std::min(nearest2, (a + at * side - p).squaredNorm());
    }
  }
  return nearest2 < most2 ? std::sqrt(nearest2) : kNone;
}

ModelShapes measure_model(const PolygonModel& model) {
  check_vertices(model);
  ModelShapes shapes;
  shapes.all_faces = model.faces.size();
  std::vector<double> areas;
  for (const Face& face : model.faces) {
    areas.push_back(face_area_m2(model, face));
    shapes.area_m2 += areas.back();
    for (const std::uint32_t v : face.outer) shapes.box.extend(model.vertices[v]);
  }
  for (const std::uint32_t f : largest_first(areas)) shapes.faces.push_back(shape_of(model, f, areas[f]));
  for (const FaceShape& face : shapes.faces) {
    shapes.kept_area_m2 += face.area_m2;
    shapes.face_planes.add(face.plane);
  }
  for (FaceShape& face : shapes.faces) {
    const Vec3 middle = middle_of(face);
    std::size_t k = 0;
    while (k < shapes.planes.size() &&
           !(shapes.planes[k].plane.normal.dot(face.plane.normal) > kSameFaceNormal &&
             std::abs(shapes.planes[k].plane.distance(middle)) < kSameFaceOffset_m))
      ++k;
    if (k == shapes.planes.size()) shapes.planes.push_back({face.plane, 0});
    shapes.planes[k].area_m2 += face.area_m2;
    face.plane_index = static_cast<std::uint32_t>(k);
  }
  return shapes;
}

}  // namespace hybrid::stages
