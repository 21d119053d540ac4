#include "stages/contours/simple_rings.hpp"

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

__extension__ using Wide = __int128;
constexpr double kNanometres = 1e9;

int sign(Wide value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}
int turn(const RingVertex& a, const RingVertex& b, const RingVertex& c) {
  return sign(Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x));
}
bool equal(const RingVertex& a, const RingVertex& b) {
  return a.x == b.x && a.y == b.y;
}
// p, known to be on the line of a and b, lies between them (ends included).
bool between(const RingVertex& a, const RingVertex& b, const RingVertex& p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

// Closed segments ab and cd have a point in common.
bool meet(const RingVertex& a, const RingVertex& b, const RingVertex& c, const RingVertex& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

struct Box {
  std::int64_t x0 = INT64_MAX, y0 = INT64_MAX, x1 = INT64_MIN, y1 = INT64_MIN;
  void add(const RingVertex& v) {
    x0 = std::min(x0, v.x), y0 = std::min(y0, v.y), x1 = std::max(x1, v.x), y1 = std::max(y1, v.y);
  }
  void add(const Box& b) {
    x0 = std::min(x0, b.x0), y0 = std::min(y0, b.y0), x1 = std::max(x1, b.x1), y1 = std::max(y1, b.y1);
  }
  void widen(std::int64_t by) { x0 -= by, y0 -= by, x1 += by, y1 += by; }
  bool meets(const Box& b) const { return x0 <= b.x1 && b.x0 <= x1 && y0 <= b.y1 && b.y0 <= y1; }
  double size() const { return static_cast<double>(x1 - x0) * static_cast<double>(y1 - y0); }
};

// Nanometres from p to the closed segment ab.
double distance_nm(const RingVertex& p, const RingVertex& a, const RingVertex& b) {
  const Vec2 side(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y)),
      arm(static_cast<double>(p.x - a.x), static_cast<double>(p.y - a.y));
  const double squared = side.squaredNorm();
  const double along = squared > 0 ? std::clamp(side.dot(arm) / squared, 0.0, 1.0) : 0;
  return (arm - along * side).norm();
}

struct RingEdge {
  std::uint32_t ring, index;  // from vertex `index` to the next one
};
using Crossing = std::pair<RingEdge, RingEdge>;

// All edges in ring order under a binary tree of boxes: successive edges are near each other. Edges meet,
// too, when an end of one comes nearer to the other than `reach_nm`.
class Crossings {
 public:
  explicit Crossings(const std::vector<FlatRing>& rings, std::int64_t reach_nm = 0)
      : rings_(rings), reach_nm_(reach_nm) {
    for (std::uint32_t r = 0; r < rings.size(); ++r)
      for (std::uint32_t i = 0; i < rings[r].vertices.size(); ++i) edges_.push_back({r, i});
    leaves_ = 1;
    while (leaves_ < edges_.size()) leaves_ *= 2;
    boxes_.resize(2 * leaves_);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      boxes_[leaves_ + i].add(start(edges_[i]));
      boxes_[leaves_ + i].add(finish(edges_[i]));
      boxes_[leaves_ + i].widen(reach_nm);
    }
    for (std::size_t i = leaves_ - 1; i > 0; --i) {
      boxes_[i] = boxes_[2 * i];
      boxes_[i].add(boxes_[2 * i + 1]);
    }
  }
  std::vector<Crossing> find() {
    if (!edges_.empty()) within(1);
    return std::move(found_);
  }

 private:
  const RingVertex& start(const RingEdge& e) const { return rings_[e.ring].vertices[e.index]; }
  const RingVertex& finish(const RingEdge& e) const {
    const auto& vertices = rings_[e.ring].vertices;
    return vertices[(e.index + 1) % vertices.size()];
  }
  void within(std::size_t node) {
    if (node >= leaves_) return;
    within(2 * node);
    within(2 * node + 1);
    across(2 * node, 2 * node + 1);
  }
  void across(std::size_t a, std::size_t b) {
    if (!boxes_[a].meets(boxes_[b])) return;
    if (a >= leaves_) {  // both are leaves: the two sides have the same depth
      test(edges_[a - leaves_], edges_[b - leaves_]);
      return;
    }
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) across(2 * a + i, 2 * b + j);
  }
  void test(const RingEdge& e, const RingEdge& f) {
    if (cross(e, f) || touch(e, f)) found_.push_back({e, f});
  }
  bool cross(const RingEdge& e, const RingEdge& f) const {
    if (e.ring == f.ring) {
      const auto count = static_cast<std::uint32_t>(rings_[e.ring].vertices.size());
      if ((e.index + 1) % count == f.index) return folds(start(e), start(f), finish(f));
      if ((f.index + 1) % count == e.index) return folds(start(f), start(e), finish(e));
      return meet(start(e), finish(e), start(f), finish(f));
    }
    // Touching vertex to vertex is allowed between rings; so is leaving such a vertex in any direction but
    // along the other edge.
    const RingVertex &a = start(e), &b = finish(e), &c = start(f), &d = finish(f);
    if (equal(a, c)) return folds(b, a, d);
    if (equal(a, d)) return folds(b, a, c);
    if (equal(b, c)) return folds(a, b, d);
    if (equal(b, d)) return folds(a, b, c);
    return meet(a, b, c, d);
  }
  bool touch(const RingEdge& e, const RingEdge& f) const {
    if (reach_nm_ == 0) return false;
    const RingVertex &a = start(e), &b = finish(e), &c = start(f), &d = finish(f);
    const auto near = [&](const RingVertex& p, const RingVertex& from, const RingVertex& to) {
      return !equal(p, from) && !equal(p, to) && distance_nm(p, from, to) < static_cast<double>(reach_nm_);
    };
    return near(a, c, d) || near(b, c, d) || near(c, a, b) || near(d, a, b);
  }
  // The path a, b, c runs back over itself.
  static bool folds(const RingVertex& a, const RingVertex& b, const RingVertex& c) {
    if (equal(a, b) || equal(b, c)) return true;
    return turn(a, b, c) == 0 && Wide(b.x - a.x) * (c.x - b.x) + Wide(b.y - a.y) * (c.y - b.y) < 0;
  }

  const std::vector<FlatRing>& rings_;
  std::int64_t reach_nm_;
  std::vector<RingEdge> edges_;
  std::vector<Box> boxes_;
  std::size_t leaves_ = 1;
  std::vector<Crossing> found_;
};

Box bounds(const FlatRing& ring) {
  Box box;
  for (const RingVertex& v : ring.vertices) box.add(v);
  return box;
}

// Marks what one crossing costs.
void mark(const std::vector<FlatRing>& rings, const Crossing& crossing,
          std::vector<std::vector<std::uint8_t>>& drop) {
  RingEdge e = crossing.first, f = crossing.second;
  if (e.ring != f.ring) {
    const bool first = bounds(rings[e.ring]).size() < bounds(rings[f.ring]).size();
    const RingEdge& loser = first ? e : f;
    const std::size_t count = rings[loser.ring].vertices.size();
    drop[loser.ring][loser.index] = drop[loser.ring][(loser.index + 1) % count] = 1;
    return;
  }
  if (e.index > f.index) std::swap(e, f);
  const std::size_t count = rings[e.ring].vertices.size();
  const std::size_t loop = f.index - e.index, rest = count - loop;  // vertices e+1 .. f, and the others
  const std::size_t most = std::max<std::size_t>(4, count / 50);
  auto& marks = drop[e.ring];
  if (loop <= rest && loop <= most) {
    for (std::size_t i = e.index + 1u; i <= f.index; ++i) marks[i] = 1;
  } else if (rest < loop && rest <= most) {
    for (std::size_t i = f.index + 1u; i <= e.index + count; ++i) marks[i % count] = 1;
  } else {
    marks[(e.index + 1u) % count] = marks[f.index] = 1;
  }
}

void drop_marked(FlatRing& ring, const std::vector<std::uint8_t>& marks) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (!marks[i]) ring.vertices[kept++] = ring.vertices[i];
  ring.vertices.resize(kept);
}

// Andrew's monotone chain: counter-clockwise, no three vertices in line.
void make_hull(FlatRing& ring) {
  auto sorted = ring.vertices;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<RingVertex> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t base = hull.size();
    for (const RingVertex& v : sorted) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), v) <= 0) hull.pop_back();
      hull.push_back(v);
    }
    hull.pop_back();  // it begins the other half
    std::reverse(sorted.begin(), sorted.end());
  }
  ring.vertices = std::move(hull);
}

}  // namespace

PlaneCoordinates::PlaneCoordinates(const Plane& plane) : origin_(plane.offset_m * plane.normal) {
  const Vec3& n = plane.normal;
  axis_x_ = (std::abs(n.z()) < 0.7 ? Vec3::UnitZ() : Vec3::UnitX()).cross(n).normalized();
  axis_y_ = n.cross(axis_x_);
}

RingVertex PlaneCoordinates::vertex(const Vec3& point) const {
  const Vec3 arm = point - origin_;
  const auto nearest = [](double nm) { return static_cast<std::int64_t>(nm + std::copysign(0.5, nm)); };
  return {nearest(arm.dot(axis_x_) * kNanometres), nearest(arm.dot(axis_y_) * kNanometres), point};
}

double signed_area2(const FlatRing& ring) {
  if (ring.vertices.size() < 3) return 0;
  Wide sum = 0;
  const RingVertex& origin = ring.vertices[0];
  for (std::size_t i = 1; i + 1 < ring.vertices.size(); ++i) {
    const RingVertex &a = ring.vertices[i], &b = ring.vertices[i + 1];
    sum += Wide(a.x - origin.x) * (b.y - origin.y) - Wide(a.y - origin.y) * (b.x - origin.x);
  }
  return static_cast<double>(sum);
}

bool are_simple(const std::vector<FlatRing>& rings) {
  return Crossings(rings).find().empty();
}

std::vector<std::size_t> touching_rings(const std::vector<FlatRing>& rings, std::int64_t reach_nm) {
  std::vector<std::size_t> touching;
  for (const auto& [e, f] : Crossings(rings, reach_nm).find())
    touching.insert(touching.end(), {e.ring, f.ring});
  std::sort(touching.begin(), touching.end());
  touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
  return touching;
}

void restore_touching(std::vector<FlatRing>& rings, const std::vector<FlatRing>& before) {
  std::vector<bool> moved(rings.size(), true);
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::size_t r : touching_rings(rings, 0)) {
      if (!moved[r]) continue;
      moved[r] = false;
      changed = true;
      rings[r] = before[r];
    }
  }
}

void make_simple(std::vector<FlatRing>& rings) {
  std::vector<std::size_t> budget;  // vertices a ring may still lose
  for (const FlatRing& ring : rings) budget.push_back(8 + ring.vertices.size() / 4);
  for (auto crossings = Crossings(rings).find(); !crossings.empty(); crossings = Crossings(rings).find()) {
    std::vector<std::vector<std::uint8_t>> drop;
    for (const FlatRing& ring : rings) drop.emplace_back(ring.vertices.size(), 0);
    for (const Crossing& crossing : crossings) mark(rings, crossing, drop);
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto lost = static_cast<std::size_t>(std::count(drop[r].begin(), drop[r].end(), 1));
      if (lost > budget[r] && rings[r].outer) {
        make_hull(rings[r]);
        budget[r] = rings[r].vertices.size();  // only a larger ring's crossings can still take from it
      } else if (lost > budget[r]) {
        rings[r].vertices.clear();
      } else {
        drop_marked(rings[r], drop[r]);
        budget[r] -= lost;
      }
      if (rings[r].vertices.size() < 3) rings[r].vertices.clear();
    }
  }
  std::erase_if(rings, [](const FlatRing& ring) {
    const double area = signed_area2(ring);
    return ring.outer ? area <= 0 : area >= 0;
  });
}

}  // namespace hybrid::stages
