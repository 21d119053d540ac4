#include "stages/contours/contour_polygons.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostBands = 1024;
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

// Where rings meet in a vertex all but the first go without it, as rounding may make them cross there.
std::vector<FlatRing> parted(const std::vector<FlatRing>& rings) {
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  std::vector<FlatRing> result;
  for (const FlatRing& ring : rings) {
    FlatRing alone{{}, ring.outer};
    for (const RingVertex& v : ring.vertices)
      if (!taken.contains({v.x, v.y})) alone.vertices.push_back(v);
    for (const RingVertex& v : alone.vertices) taken.insert({v.x, v.y});
    if (alone.vertices.size() >= 3 && (signed_area2(alone) > 0) == (signed_area2(ring) > 0))
      result.push_back(std::move(alone));
  }
  return result;
}

double spacing_nm(const RangeImage& image, const Plane& plane, const Vec3& point) {
  const double range = point.norm();
  const double cosine = std::max(std::abs(plane.normal.dot(point)) / range, 1 / kLongestStretch);
  return 1e9 * range * image.step_rad() / cosine;
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
  for (const auto* candidate : {&straight, &rings})
    if (auto apart = parted(*candidate); are_simple(apart)) return apart;
  return rings;
}

namespace {

// Whether a line from the point towards greater x crosses the edge. Counted over a ring's edges it tells
// whether the point is inside.
bool crosses(std::int64_t from_x, std::int64_t from_y, std::int64_t to_x, std::int64_t to_y,
             const RingVertex& p) {
  if ((from_y > p.y) == (to_y > p.y)) return false;
  const double x = static_cast<double>(to_x - from_x) *
                   (static_cast<double>(p.y - from_y) / static_cast<double>(to_y - from_y));
  return static_cast<double>(p.x - from_x) < x;
}

bool inside(const FlatRing& ring, const RingVertex& p) {
  bool odd = false;
  const auto& v = ring.vertices;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++)
    odd ^= crosses(v[i].x, v[i].y, v[j].x, v[j].y, p);
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

InsideRings::InsideRings(const std::vector<FlatRing>& rings) {
  for (const FlatRing& ring : rings) {
    const auto& v = ring.vertices;
    for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++)
      edges_.push_back({v[i].x, v[i].y, v[j].x, v[j].y});
  }
  if (edges_.empty()) return;
  low_y_ = high_y_ = edges_[0].from_y;
  for (const Edge& edge : edges_) {
    low_y_ = std::min({low_y_, edge.from_y, edge.to_y});
    high_y_ = std::max({high_y_, edge.from_y, edge.to_y});
  }
  const auto wanted = static_cast<std::int64_t>(std::min(edges_.size(), kMostBands));
  band_nm_ = (high_y_ - low_y_) / wanted + 1;
  first_.assign(band(high_y_) + 2, 0);
  const auto each_band = [&](const Edge& edge, const auto& act) {
    const std::size_t last = band(std::max(edge.from_y, edge.to_y));
    for (std::size_t b = band(std::min(edge.from_y, edge.to_y)); b <= last; ++b) act(b);
  };
  for (const Edge& edge : edges_) each_band(edge, [&](std::size_t b) { ++first_[b + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  of_band_.resize(first_.back());
  std::vector<std::uint32_t> next = first_;
  for (std::size_t e = 0; e < edges_.size(); ++e)
    each_band(edges_[e], [&](std::size_t b) { of_band_[next[b]++] = static_cast<std::uint32_t>(e); });
}

bool InsideRings::operator()(const RingVertex& p) const {
  if (edges_.empty() || p.y < low_y_ || p.y > high_y_) return false;
  bool odd = false;
  const std::size_t b = band(p.y);
  for (std::uint32_t k = first_[b]; k < first_[b + 1]; ++k) {
    const Edge& edge = edges_[of_band_[k]];
    odd ^= crosses(edge.from_x, edge.from_y, edge.to_x, edge.to_y, p);
  }
  return odd;
}

bool InsideRings::border_near(const RingVertex& low, const RingVertex& high) const {
  if (edges_.empty() || high.y < low_y_ || low.y > high_y_) return false;
  const std::size_t last = band(std::min(high.y, high_y_));
  for (std::size_t b = band(std::max(low.y, low_y_)); b <= last; ++b)
    for (std::uint32_t k = first_[b]; k < first_[b + 1]; ++k) {
      const Edge& e = edges_[of_band_[k]];
      if (std::max(e.from_y, e.to_y) >= low.y && std::min(e.from_y, e.to_y) <= high.y &&
          std::max(e.from_x, e.to_x) >= low.x && std::min(e.from_x, e.to_x) <= high.x)
        return true;
    }
  return false;
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
  return model;
}

}  // namespace hybrid::stages
