#include "geometry/keyhole.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>

#include "geometry/outline.hpp"

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
  return face.holes.empty() ? face.outer : Outline(model, face).bridged();
}

}  // namespace hybrid
