#include "geometry/keyhole.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/error.hpp"

namespace hybrid {
namespace {

using Ring = std::vector<std::uint32_t>;

// Newell's vector: length = twice the area, direction = front side.
Vec3 area_vector(const PolygonModel& model, const Ring& ring) {
  Vec3 sum = Vec3::Zero();
  const Vec3& origin = model.vertices[ring.front()];
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += (model.vertices[ring[i]] - origin).cross(model.vertices[ring[(i + 1) % ring.size()]] - origin);
  return sum;
}

// Positions i < j with edge j the reverse of edge i; nothing for a ring without a keyhole.
std::optional<std::pair<std::size_t, std::size_t>> find_bridge(const Ring& ring) {
  std::unordered_map<std::uint64_t, std::size_t> edges;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::uint64_t from = ring[i], to = ring[(i + 1) % ring.size()];
    if (const auto reverse = edges.find(to << 32 | from); reverse != edges.end())
      return std::pair{reverse->second, i};
    edges.emplace(from << 32 | to, i);
  }
  return std::nullopt;
}

// The loops between the bridges of `ring`; loops of fewer than three vertices (spikes) are dropped.
std::vector<Ring> loops_of(Ring ring) {
  std::vector<Ring> open{std::move(ring)}, loops;
  while (!open.empty()) {
    Ring current = std::move(open.back());
    open.pop_back();
    if (current.size() < 3) continue;
    const auto bridge = find_bridge(current);
    if (!bridge) {
      loops.push_back(std::move(current));
      continue;
    }
    const auto begin = current.begin();
    const auto i = static_cast<std::ptrdiff_t>(bridge->first),
               j = static_cast<std::ptrdiff_t>(bridge->second);
    open.emplace_back(begin + i + 1, begin + j);
    Ring around(begin + j + 1, current.end());
    around.insert(around.end(), begin, begin + i);
    open.push_back(std::move(around));
  }
  return loops;
}

// The face's plane coordinates in which its outer ring runs counter-clockwise.
class Flat {
 public:
  Flat(const PolygonModel& model, const Face& face)
      : model_(model), origin_(model.vertices[face.outer.front()]) {
    const Vec3 normal = area_vector(model, face.outer).stableNormalized();
    x_ = normal.unitOrthogonal();
    y_ = normal.cross(x_);
  }
  Vec2 operator()(std::uint32_t vertex) const {
    const Vec3 from_origin = model_.vertices[vertex] - origin_;
    return {from_origin.dot(x_), from_origin.dot(y_)};
  }
  // Twice the signed area: positive when c lies to the left of a -> b.
  double side(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec2 p = (*this)(a), u = (*this)(b)-p, v = (*this)(c)-p;
    return u.x() * v.y() - u.y() * v.x();
  }

 private:
  const PolygonModel& model_;
  Vec3 origin_, x_, y_;
};

// O'Rourke, Computational Geometry in C, 1.6: does the segment from ring[at] to `target` start inside the
// polygon that lies to the left of `ring`?
bool starts_inside(const Flat& flat, const Ring& ring, std::size_t at, std::uint32_t target) {
  const std::uint32_t here = ring[at];
  const std::uint32_t before = ring[(at + ring.size() - 1) % ring.size()],
                      after = ring[(at + 1) % ring.size()];
  if (flat.side(before, here, after) >= 0)
    return flat.side(here, target, before) > 0 && flat.side(target, here, after) > 0;
  return !(flat.side(here, target, after) >= 0 && flat.side(target, here, before) >= 0);
}

bool between(const Vec2& a, const Vec2& b, const Vec2& point) {
  return (point - a).dot(point - b) <= 0;
}

// Does the open segment p-q meet an edge of `ring` that does not end at p or q?
bool blocked(const Flat& flat, const Ring& ring, std::uint32_t p, std::uint32_t q) {
  const Vec2 from = flat(p), to = flat(q), low = from.cwiseMin(to), high = from.cwiseMax(to);
  Vec2 end = flat(ring[0]);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::uint32_t c = ring[i], d = ring[(i + 1) % ring.size()];
    const Vec2 begin = std::exchange(end, flat(d));
    // Most edges lie elsewhere.
    if ((begin.cwiseMax(end).array() < low.array()).any() ||
        (begin.cwiseMin(end).array() > high.array()).any())
      continue;
    if (c == p || c == q || d == p || d == q) continue;
    const double pqc = flat.side(p, q, c), pqd = flat.side(p, q, d);
    const double cdp = flat.side(c, d, p), cdq = flat.side(c, d, q);
    if (((pqc > 0) != (pqd > 0)) && ((cdp > 0) != (cdq > 0))) return true;
    if (pqc == 0 && between(flat(p), flat(q), flat(c))) return true;
    if (pqd == 0 && between(flat(p), flat(q), flat(d))) return true;
  }
  return false;
}

struct Bridge {
  std::size_t at = 0, hole = 0, hole_at = 0;  // ring[at] to holes[hole][hole_at]
};

std::optional<Bridge> shortest_bridge(const Flat& flat, const PolygonModel& model, const Ring& ring,
                                      const std::vector<Ring>& holes) {
  std::optional<Bridge> best;
  double best_length = std::numeric_limits<double>::infinity();
  for (std::size_t at = 0; at < ring.size(); ++at) {
    for (std::size_t hole = 0; hole < holes.size(); ++hole) {
      for (std::size_t hole_at = 0; hole_at < holes[hole].size(); ++hole_at) {
        const std::uint32_t p = ring[at], q = holes[hole][hole_at];
        const double length = (model.vertices[p] - model.vertices[q]).squaredNorm();
        if (!(length < best_length) || !starts_inside(flat, ring, at, q) ||
            !starts_inside(flat, holes[hole], hole_at, p) || blocked(flat, ring, p, q))
          continue;
        if (std::any_of(holes.begin(), holes.end(), [&](const Ring& r) { return blocked(flat, r, p, q); }))
          continue;
        best = {at, hole, hole_at};
        best_length = length;
      }
    }
  }
  return best;
}

}  // namespace

void split_keyholes(const PolygonModel& model, Face& face) {
  if (!find_bridge(face.outer)) return;
  std::vector<Ring> loops = loops_of(face.outer);
  if (loops.empty()) return;
  const auto outer = std::max_element(loops.begin(), loops.end(), [&](const Ring& a, const Ring& b) {
    return area_vector(model, a).squaredNorm() < area_vector(model, b).squaredNorm();
  });
  face.outer = *outer;
  loops.erase(outer);
  const Vec3 front = area_vector(model, face.outer);
  for (Ring& hole : loops) {
    if (area_vector(model, hole).dot(front) > 0) std::reverse(hole.begin(), hole.end());
    face.holes.push_back(std::move(hole));
  }
}

std::vector<std::uint32_t> keyhole_ring(const PolygonModel& model, const Face& face) {
  const Flat flat(model, face);
  Ring ring = face.outer;
  std::vector<Ring> holes = face.holes;
  while (!holes.empty()) {
    const auto bridge = shortest_bridge(flat, model, ring, holes);
    if (!bridge)
      fail_input(
          "face {}: expected holes inside its outer ring that cross nothing, found {} that no edge reaches; "
          "separate the rings",
          face.name, holes.size());
    Ring hole = holes[bridge->hole];
    std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(bridge->hole_at), hole.end());
    hole.push_back(hole.front());
    hole.push_back(ring[bridge->at]);
    ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(bridge->at) + 1, hole.begin(), hole.end());
    holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(bridge->hole));
  }
  return ring;
}

}  // namespace hybrid
