#include "score/measure/openings.hpp"

#include <algorithm>
#include <cmath>

#include "score/measure/polygon.hpp"

namespace score {
namespace {

constexpr double kParallel = 0.866;  // cosine of 30 degrees

struct Face {
  Plane plane;
  PlanePolygon polygon;

  bool closes(const Vec3& point, const Vec3& normal) const {
    return std::abs(plane.normal.dot(normal)) >= kParallel &&
           std::abs(plane.normal.dot(point) - plane.offset_m) <= kFaceReachM && polygon.covers(point);
  }
};

std::vector<Face> faces_of(const std::vector<Ring>& rings) {
  std::vector<Face> faces;
  for (const Ring& ring : rings) {
    const Plane plane = plane_of_ring(ring);
    faces.push_back({plane, PlanePolygon(plane, {ring})});
  }
  return faces;
}

bool closed(const std::vector<Face>& faces, const Vec3& point, const Vec3& normal) {
  return std::any_of(faces.begin(), faces.end(),
                     [&](const Face& face) { return face.closes(point, normal); });
}

// Midpoints of the grid's cells inside the ring.
std::vector<Vec3> points_inside(const Ring& ring) {
  const Plane plane = plane_of_ring(ring);
  const PlanePolygon polygon(plane, {ring});
  const auto [u, v] = axes_across(plane.normal);
  Vec2 low = Vec2::Constant(1e300), high = -low;
  for (const Vec3& corner : ring) {
    const Vec2 flat(u.dot(corner), v.dot(corner));
    low = low.cwiseMin(flat);
    high = high.cwiseMax(flat);
  }
  std::vector<Vec3> points;
  for (double y = low.y() + kOpeningStepM / 2; y < high.y(); y += kOpeningStepM)
    for (double x = low.x() + kOpeningStepM / 2; x < high.x(); x += kOpeningStepM) {
      const Vec3 point = plane.offset_m * plane.normal + x * u + y * v;
      if (polygon.covers(point)) points.push_back(point);
    }
  return points;
}

constexpr double kCellM2 = kOpeningStepM * kOpeningStepM;

// Area of the rings' insides where `wrong` says so.
template <typename Wrong>
double area_where(const std::vector<Ring>& rings, const Wrong& wrong) {
  std::int64_t cells = 0;
  for (const Ring& ring : rings) {
    const Vec3 normal = plane_of_ring(ring).normal;
    for (const Vec3& point : points_inside(ring)) cells += wrong(point, normal);
  }
  return static_cast<double>(cells) * kCellM2;
}

template <typename Good>
double share_where(const std::vector<Vec3>& points, const Good& good) {
  const auto count = std::count_if(points.begin(), points.end(), good);
  return points.empty() ? 0 : static_cast<double>(count) / static_cast<double>(points.size());
}

double distance_to_rings(const Vec3& point, const std::vector<Ring>& rings) {
  double nearest = 1e300;
  for (const Ring& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec3 &a = ring[i], arm = ring[(i + 1) % ring.size()] - a;
      const double along = std::clamp((point - a).dot(arm) / std::max(1e-30, arm.squaredNorm()), 0.0, 1.0);
      nearest = std::min(nearest, (point - a - along * arm).norm());
    }
  return nearest;
}

// 95th percentile of the distance from places every centimetre along a ring.
double border_distance(const Ring& ring, const std::vector<Ring>& reported) {
  constexpr double kStep_m = 0.01;
  std::vector<double> distances;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 &a = ring[i], arm = ring[(i + 1) % ring.size()] - a;
    const int parts = std::max(1, static_cast<int>(std::ceil(arm.norm() / kStep_m)));
    for (int k = 0; k < parts; ++k)
      distances.push_back(distance_to_rings(a + (k + 0.5) / parts * arm, reported));
  }
  std::sort(distances.begin(), distances.end());
  return distances[distances.size() * 95 / 100];
}

}  // namespace

// Newell's normal: right for concave rings too.
Plane plane_of_ring(const Ring& ring) {
  Vec3 normal = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    normal += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
    mean += ring[i] / static_cast<double>(ring.size());
  }
  normal.normalize();
  return {normal, normal.dot(mean)};
}

OpeningScore score_openings(const std::vector<TrueOpening>& truth, const EditedModel& result,
                            const std::vector<Ring>& proxy) {
  OpeningScore score;
  const auto edited = faces_of(result.polygons.value_or(std::vector<Ring>{}));
  const auto reported = faces_of(result.reported.value_or(std::vector<Ring>{}));
  std::vector<Ring> true_rings;
  for (const TrueOpening& opening : truth) {
    true_rings.push_back(opening.ring);
    const auto points = points_inside(opening.ring);
    const Vec3 normal = plane_of_ring(opening.ring).normal;
    OpeningScore::One one{
        opening.name, opening.face, static_cast<double>(points.size()) * kCellM2, {}, {}, {}, {}, {}};
    if (result.polygons)
      one.open_share = share_where(points, [&](const Vec3& point) { return !closed(edited, point, normal); });
    if (result.reported)
      one.reported_share =
          share_where(points, [&](const Vec3& point) { return closed(reported, point, normal); });
    if (one.reported_share && *one.reported_share >= 0.5)
      one.border_m = border_distance(opening.ring, *result.reported);
    score.openings.push_back(one);
  }
  const auto true_faces = faces_of(true_rings);
  if (result.polygons && !proxy.empty())
    score.wrongly_open_m2 = area_where(proxy, [&](const Vec3& point, const Vec3& normal) {
      return !closed(true_faces, point, normal) && !closed(edited, point, normal);
    });
  if (result.reported) {
    const auto outside = [&](const Vec3& point, const Vec3& normal) {
      return !closed(true_faces, point, normal);
    };
    score.wrongly_reported_m2 = area_where(*result.reported, outside);
    score.false_openings = static_cast<int>(
        std::count_if(result.reported->begin(), result.reported->end(), [&](const Ring& ring) {
          const Vec3 normal = plane_of_ring(ring).normal;
          return share_where(points_inside(ring), [&](const Vec3& p) { return outside(p, normal); }) > 0.5;
        }));
  }
  return score;
}

std::optional<double> OpeningScore::One::border_bound_m() const {
  if (!spacing_m) return std::nullopt;
  return std::max(0.03, 2 * *spacing_m);
}

OpeningTally tally(const OpeningScore& score) {
  OpeningTally tally;
  for (const auto& one : score.openings) {
    if (one.rays.value_or(0) < kCountedRays) continue;
    ++tally.openings;
    tally.found += one.reported_share.value_or(0) >= 0.5;
    tally.within_bound += one.border_m && *one.border_m <= *one.border_bound_m();
  }
  return tally;
}

}  // namespace score
