#include "stages/contours/widened_rings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hybrid::stages {
namespace {

constexpr double kOnLine_m = 1e-6;  // straightened contours lie on their lines but for rounding
// Of a move and the line of sight; what is seen more obliquely goes no farther.
constexpr double kLeastSine = 1. / 3;
constexpr double kMostMitre = 2;                   // of a vertex, against the moves of its sides
constexpr double kStraight = 0.99, kSpike = -0.9;  // cosines of the turn at a vertex

// A side of a ring goes `by_m` along `out`, which is normal to it and leads away from the plane's samples.
struct Side {
  Vec3 out;
  double by_m;
};

// Where the lines of two sides meet after their moves.
Vec3 move_of_vertex(const Side& before, const Side& after) {
  const double cosine = before.out.dot(after.out);
  if (cosine < kSpike) return Vec3::Zero();
  if (cosine > kStraight) return 0.5 * (before.by_m + after.by_m) * (before.out + after.out).normalized();
  const Vec3 move =
      ((before.by_m - cosine * after.by_m) * before.out + (after.by_m - cosine * before.by_m) * after.out) /
      (1 - cosine * cosine);
  const double most_m = kMostMitre * std::max(before.by_m, after.by_m);
  return move.norm() > most_m ? Vec3(most_m * move.normalized()) : move;
}

FlatRing widened(const FlatRing& ring, const Plane& plane, const std::vector<Intersection>& lines,
                 double step_rad) {
  const PlaneCoordinates coordinates(plane);
  const std::size_t n = ring.vertices.size();
  std::vector<Side> sides;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &from = ring.vertices[i].point, &to = ring.vertices[(i + 1) % n].point;
    const bool known = std::any_of(lines.begin(), lines.end(), [&](const Intersection& line) {
      const Vec3 along = (line.to - line.from).normalized();
      return std::max((from - line.from).cross(along).norm(), (to - line.from).cross(along).norm()) <
             kOnLine_m;
    });
    // Material is on the left of a ring as the plane's normal has it.
    const Vec3 out = (to - from).cross(plane.normal).normalized(), middle = 0.5 * (from + to);
    sides.push_back({out, known ? 0 : step_rad * step_across(middle, out)});
  }
  FlatRing result{{}, ring.outer};
  for (std::size_t i = 0; i < n; ++i)
    result.vertices.push_back(
        coordinates.vertex(ring.vertices[i].point + move_of_vertex(sides[(i + n - 1) % n], sides[i])));
  return result;
}

}  // namespace

double step_across(const Vec3& point, const Vec3& out) {
  return point.norm() / std::max(out.cross(point.normalized()).norm(), kLeastSine);
}

std::vector<FlatRing> widened_rings(const RangeImage& image, const Supercluster& supercluster,
                                    const std::vector<Intersection>& intersections, double steps,
                                    const std::vector<FlatRing>& rings) {
  std::vector<Intersection> lines;
  std::copy_if(intersections.begin(), intersections.end(), std::back_inserter(lines), [&](const auto& line) {
    return line.planes[0] == supercluster.id || line.planes[1] == supercluster.id;
  });
  std::vector<FlatRing> result;
  for (const FlatRing& ring : rings) {
    FlatRing wide = widened(ring, supercluster.plane, lines, steps * image.step_rad());
    // A hole that is narrower than its sides' moves.
    const bool turned = (signed_area2(wide) > 0) != (signed_area2(ring) > 0);
    result.push_back(turned ? ring : std::move(wide));
  }
  restore_touching(result, rings);
  return result;
}

}  // namespace hybrid::stages
