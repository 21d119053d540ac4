#include "geometry/flat_ring.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hybrid {
namespace {

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

bool on_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (p - a).dot(p - b) <= 0;
}

// Including touching ends and overlaps.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
    return true;
  return (abc == 0 && on_segment(a, b, c)) || (abd == 0 && on_segment(a, b, d)) ||
         (cda == 0 && on_segment(c, d, a)) || (cdb == 0 && on_segment(c, d, b));
}

// Marks the vertices to keep strictly between `first` and `last` of an open line.
void keep_farthest(const Ring2& line, std::size_t first, std::size_t last, double tolerance,
                   std::vector<bool>& keep) {
  double farthest = tolerance;
  std::size_t at = 0;
  for (std::size_t i = first + 1; i < last; ++i)
    if (const double d = distance_to_segment(line[i], line[first], line[last]); d > farthest) {
      farthest = d;
      at = i;
    }
  if (at == 0) return;
  keep[at] = true;
  keep_farthest(line, first, at, tolerance, keep);
  keep_farthest(line, at, last, tolerance, keep);
}

}  // namespace

double signed_area(const Ring2& ring) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += 0.5 * turn(ring[0], ring[i], ring[i + 1]);
  return sum;
}

bool inside(const Ring2& ring, const Vec2& point) {
  bool odd = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Vec2 &a = ring[i], &b = ring[j];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()))
      odd = !odd;
  }
  return odd;
}

double distance_to_segment(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 arm = to - from;
  const double length2 = arm.squaredNorm();
  const double along = length2 > 0 ? std::clamp((point - from).dot(arm) / length2, 0.0, 1.0) : 0.0;
  return (point - from - along * arm).norm();
}

Box2 box_of(const Ring2& ring) {
  Box2 box{ring[0], ring[0]};
  for (const Vec2& p : ring) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

double distance_to_border(const Ring2& ring, const Vec2& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i)
    nearest = std::min(nearest, distance_to_segment(point, ring[i], ring[(i + 1) % ring.size()]));
  return nearest;
}

std::optional<std::pair<std::size_t, std::size_t>> self_crossing(const Ring2& ring) {
  const std::size_t n = ring.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = ring[i], &b = ring[(i + 1) % n];
    if (a == b) return std::pair{i, (i + 1) % n};
    for (std::size_t j = i + 1; j < n; ++j) {
      const Vec2 &c = ring[j], &d = ring[(j + 1) % n];
      const bool follows = j == i + 1, precedes = (j + 1) % n == i;
      // Neighbours share a vertex; they meet elsewhere only when one folds back onto the other.
      if (follows || precedes) {
        const Vec2 &shared = follows ? b : a, &p = follows ? a : b, &q = follows ? d : c;
        if (turn(p, shared, q) == 0 && (p - shared).dot(q - shared) > 0) return std::pair{i, j};
        continue;
      }
      if (segments_meet(a, b, c, d)) return std::pair{i, j};
    }
  }
  return std::nullopt;
}

bool borders_meet(const Ring2& a, const Ring2& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (segments_meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
  return false;
}

std::vector<std::size_t> vertices_kept(const Ring2& ring, double tolerance) {
  std::vector<std::size_t> all(ring.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (ring.size() < 4) return all;
  // Two vertices that surely stay: the farthest from the centre, and the farthest from that one.
  Vec2 centre = Vec2::Zero();
  for (const Vec2& p : ring) centre += p / static_cast<double>(ring.size());
  const auto farthest_from = [](const Ring2& points, const Vec2& from) {
    return std::max_element(points.begin(), points.end(),
                            [&](const Vec2& p, const Vec2& q) {
                              return (p - from).squaredNorm() < (q - from).squaredNorm();
                            }) -
           points.begin();
  };
  const auto start = farthest_from(ring, centre);
  Ring2 line(ring.begin() + start, ring.end());
  line.insert(line.end(), ring.begin(), ring.begin() + start + 1);
  const auto middle = static_cast<std::size_t>(farthest_from(line, line[0]));
  std::vector<bool> keep(line.size(), false);
  keep.front() = keep[middle] = true;
  keep_farthest(line, 0, middle, tolerance, keep);
  keep_farthest(line, middle, line.size() - 1, tolerance, keep);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    if (keep[i]) kept.push_back((i + static_cast<std::size_t>(start)) % ring.size());
  std::sort(kept.begin(), kept.end());
  return kept;
}

Ring2 simplified(const Ring2& ring, double tolerance) {
  Ring2 result;
  for (const std::size_t i : vertices_kept(ring, tolerance)) result.push_back(ring[i]);
  return result;
}

}  // namespace hybrid
