#include "stages/contour_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

constexpr double kLongestStretch = 3;  // of the sample spacing at grazing incidence

// Marks the vertices that Douglas and Peucker keep between first and last (indices modulo the ring's size).
void keep_corners(const FlatRing& ring, const std::vector<double>& tolerance_nm, std::size_t first,
                  std::size_t last, std::vector<bool>& kept) {
  const std::size_t n = ring.vertices.size();
  std::vector<std::pair<std::size_t, std::size_t>> spans{{first, last}};
  while (!spans.empty()) {
    const auto [begin, end] = spans.back();
    spans.pop_back();
    const RingVertex &a = ring.vertices[begin % n], &b = ring.vertices[end % n];
    const double ux = static_cast<double>(b.x - a.x), uy = static_cast<double>(b.y - a.y);
    const double length2 = ux * ux + uy * uy;
    double worst = 1;
    std::size_t at = 0;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const RingVertex& v = ring.vertices[i % n];
      double x = static_cast<double>(v.x - a.x), y = static_cast<double>(v.y - a.y);
      const double share = length2 > 0 ? std::clamp((x * ux + y * uy) / length2, 0.0, 1.0) : 0;
      x -= share * ux, y -= share * uy;
      const double off = std::sqrt(x * x + y * y) / tolerance_nm[i % n];
      if (off > worst) worst = off, at = i;
    }
    if (at == 0) continue;
    kept[at % n] = true;
    spans.push_back({begin, at});
    spans.push_back({at, end});
  }
}

// The ring without the vertices that lie within their tolerance of the line through those that stay.
FlatRing straightened(const FlatRing& ring, const std::vector<double>& tolerance_nm) {
  const auto& v = ring.vertices;
  const auto far2 = [&](std::size_t i) {
    const double x = static_cast<double>(v[i].x - v[0].x), y = static_cast<double>(v[i].y - v[0].y);
    return x * x + y * y;
  };
  std::size_t far = 0;
  for (std::size_t i = 1; i < v.size(); ++i)
    if (far2(i) > far2(far)) far = i;
  std::vector<bool> kept(v.size(), false);
  kept[0] = kept[far] = true;
  keep_corners(ring, tolerance_nm, 0, far, kept);
  keep_corners(ring, tolerance_nm, far, v.size(), kept);
  FlatRing result{{}, ring.outer};
  for (std::size_t i = 0; i < v.size(); ++i)
    if (kept[i]) result.vertices.push_back(v[i]);
  return result;
}

double spacing_nm(const RangeImage& image, const Plane& plane, const Vec3& point) {
  const double range = point.norm();
  const double cosine = std::max(std::abs(plane.normal.dot(point)) / range, 1 / kLongestStretch);
  return 1e9 * range * std::max(image.elevation_step_rad(), image.azimuth_step_rad()) / cosine;
}

}  // namespace

std::vector<FlatRing> flat_rings(const RangeImage& image, const Supercluster& supercluster,
                                 double straighten) {
  const PlaneCoordinates coordinates(supercluster.plane);
  std::vector<FlatRing> rings, straight;
  for (const ContourRing& contour : supercluster.contours) {
    FlatRing ring{{}, contour.outer};
    std::vector<double> tolerance_nm;
    for (const Vec3& point : contour.points) {
      ring.vertices.push_back(coordinates.vertex(point));
      tolerance_nm.push_back(std::max(straighten * spacing_nm(image, supercluster.plane, point), 1.0));
    }
    if (ring.vertices.size() < 3) continue;
    FlatRing line = straightened(ring, tolerance_nm);
    const bool same_side = line.vertices.size() >= 3 && (signed_area2(line) > 0) == (signed_area2(ring) > 0);
    straight.push_back(same_side ? std::move(line) : ring);
    rings.push_back(std::move(ring));
  }
  return are_simple(straight) ? straight : rings;
}

namespace {

// Crossing number; points on an edge fall to one side or the other.
bool inside(const FlatRing& ring, const RingVertex& p) {
  bool odd = false;
  const auto& v = ring.vertices;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    if ((v[i].y > p.y) == (v[j].y > p.y)) continue;
    const double x = static_cast<double>(v[j].x - v[i].x) *
                     (static_cast<double>(p.y - v[i].y) / static_cast<double>(v[j].y - v[i].y));
    odd ^= static_cast<double>(p.x - v[i].x) < x;
  }
  return odd;
}

// The smallest outer ring around a hole: most of the hole's vertices are inside it (some may be its own).
std::optional<std::size_t> owner(const std::vector<FlatRing>& rings, const FlatRing& hole) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (!rings[i].outer || std::abs(signed_area2(rings[i])) <= std::abs(signed_area2(hole))) continue;
    const auto within = std::count_if(hole.vertices.begin(), hole.vertices.end(),
                                      [&](const RingVertex& v) { return inside(rings[i], v); });
    if (2 * within <= static_cast<std::ptrdiff_t>(hole.vertices.size())) continue;
    if (!best || std::abs(signed_area2(rings[i])) < std::abs(signed_area2(rings[*best]))) best = i;
  }
  return best;
}

std::vector<std::uint32_t> append_vertices(const FlatRing& ring, PolygonModel& model) {
  std::vector<std::uint32_t> indices;
  for (const RingVertex& vertex : ring.vertices) {
    indices.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(vertex.point);
  }
  return indices;
}

}  // namespace

bool inside(const std::vector<FlatRing>& rings, const RingVertex& p) {
  bool odd = false;
  for (const FlatRing& ring : rings) odd ^= inside(ring, p);
  return odd;
}

PolygonModel polygons_of(const std::vector<FlatRing>& rings) {
  PolygonModel model;
  std::vector<std::size_t> face_of(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (!rings[i].outer) continue;
    face_of[i] = model.faces.size();
    model.faces.push_back({"", append_vertices(rings[i], model), {}});
  }
  for (const FlatRing& ring : rings)
    if (!ring.outer)
      if (const auto i = owner(rings, ring))
        model.faces[face_of[*i]].holes.push_back(append_vertices(ring, model));
  return can_be_triangulated(model) ? model : PolygonModel();  // else its samples stay
}

}  // namespace hybrid::stages
