#include <algorithm>

#include "cases/closest_point_case.hpp"

namespace hybrid::testing {
namespace {

double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

Vec3 normal_of(const PolygonModel& m, const Triangle& t) {
  return (m.vertices[t.vertices[1]] - m.vertices[t.vertices[0]])
      .cross(m.vertices[t.vertices[2]] - m.vertices[t.vertices[0]])
      .normalized();
}

}  // namespace

// By barycentric coordinates of the foot point: inside, else the nearest of the sides.
double ClosestPointCase::distance_to(const Input& input, const Triangle& t, const Vec3& point_in_local) {
  const Vec3 p = point_in_local + input.origin, a = input.model.vertices[t.vertices[0]],
             b = input.model.vertices[t.vertices[1]], c = input.model.vertices[t.vertices[2]];
  Mat3 frame;
  frame << b - a, c - a, normal_of(input.model, t);
  const Vec3 coordinates = frame.inverse() * (p - a);
  if (coordinates.x() >= 0 && coordinates.y() >= 0 && coordinates.x() + coordinates.y() <= 1)
    return std::abs(coordinates.z());
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

ClosestPointCase::Output ClosestPointCase::reference(const Input& input) {
  const auto triangles = triangulate(input.model);
  Output out;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    const Vec3 p = input.local_from_scan * Vec3(input.x[i], input.y[i], input.z[i]);
    const Vec3 n = input.local_from_scan.rotate(Vec3(input.nx[i], input.ny[i], input.nz[i]));
    double best = input.gate_m;
    std::uint32_t index = NO_TRIANGLE;
    bool doubtful = false;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const double facing = n.dot(normal_of(input.model, triangles[t])) - min_cosine(input.normal_deg);
      doubtful |= std::abs(facing) < 1e-5;
      if (facing < 0 || !(distance_to(input, triangles[t], p) < best)) continue;
      best = distance_to(input, triangles[t], p);
      index = static_cast<std::uint32_t>(t);
    }
    out.distance.push_back(index == NO_TRIANGLE ? NAN : static_cast<float>(best));
    out.triangle.push_back(index);
    out.doubtful.push_back(doubtful);
  }
  return out;
}

}  // namespace hybrid::testing
