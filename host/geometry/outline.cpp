#include "geometry/outline.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/error.hpp"

namespace hybrid {
namespace {

constexpr double kSidesPerCell = 2;
constexpr std::size_t kMostCells = 1024;  // in a row

}  // namespace

void SideGrid::open(const Vec2& low, const Vec2& high, std::size_t count) {
  width_ = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::sqrt(static_cast<double>(count) / kSidesPerCell)), 1, kMostCells);
  low_ = low;
  size_ = (high - low).maxCoeff() / static_cast<double>(width_);
  cells_.assign(width_ * width_, {});
}

std::size_t SideGrid::cell(double along) const {
  const double k = along / size_;
  return k > 0 ? std::min(static_cast<std::size_t>(k), width_ - 1) : 0;
}

// Row by row of the grid: the cells between where the side enters and leaves it, and one on each side more
// than rounding could miss.
void SideGrid::add(std::uint32_t side, const Vec2& from, const Vec2& to) {
  const Vec2 a = (from.y() <= to.y() ? from : to) - low_, b = (from.y() <= to.y() ? to : from) - low_;
  const double slope = b.y() > a.y() ? (b.x() - a.x()) / (b.y() - a.y()) : 0, margin = 1e-6 * size_;
  const auto [left, right] = std::minmax(a.x(), b.x());
  for (std::size_t row = cell(a.y() - margin); row <= cell(b.y() + margin); ++row) {
    double enters = left, leaves = right;
    if (b.y() - a.y() > size_) {
      const double low = a.x() + slope * (static_cast<double>(row) * size_ - a.y()),
                   high = low + slope * size_;
      enters = std::max(left, std::min(low, high)), leaves = std::min(right, std::max(low, high));
    }
    for (std::size_t col = cell(enters - margin); col <= cell(leaves + margin); ++col)
      cells_[row * width_ + col].push_back(side);
  }
}

Outline::Outline(const PolygonModel& model, const Face& face) : face_(face) {
  const Vec3 normal = face_plane(model, face).normal;
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  double size = 0;
  for (const std::uint32_t index : face.outer)
    size = std::max(size, (model.vertices[index] - model.vertices[face.outer[0]]).norm());
  tolerance_ = 1e-12 * size * size;
  ring_ = flatten(model, face.outer, u, v, 1);
  for (const Ring& hole : face.holes) holes_.push_back(flatten(model, hole, u, v, -1));
  area_ = area(ring_);
  for (const Ring& hole : holes_) area_ += area(hole);
}

Outline::Ring Outline::flatten(const PolygonModel& model, const Ring& ring, const Vec3& u, const Vec3& v,
                               int sign) {
  const Vec3 base = model.vertices[face_.outer[0]];
  Ring own;
  for (const std::uint32_t index : ring) {
    const Vec3 arm = model.vertices[index] - base;
    own.push_back(static_cast<std::uint32_t>(flat_.size()));
    flat_.emplace_back(arm.dot(u), arm.dot(v));
    model_vertex_.push_back(index);
  }
  return oriented(own, sign);
}

std::vector<std::uint32_t> Outline::bridged() {
  bridge_holes();
  Ring ring;
  for (const std::uint32_t vertex : ring_) ring.push_back(model_vertex_[vertex]);
  return ring;
}

std::vector<std::array<std::uint32_t, 3>> Outline::triangles() {
  bridge_holes();
  begin_clipping();
  std::vector<std::array<std::uint32_t, 3>> found;
  double clipped = 0;
  // Every other vertex in turn: diagonals grow as slowly as they can, and with them what is near them.
  std::size_t from = 0;
  while (ring_.size() >= 3) {
    const std::size_t i = find_ear(from);
    from = i + 1;
    if (i == ring_.size()) {
      if (!drop_flat_vertex()) fail_crossing();
      continue;
    }
    found.push_back({model_vertex_[before(i)], model_vertex_[ring_[i]], model_vertex_[after(i)]});
    clipped += 0.5 * turn(before(i), ring_[i], after(i));
    drop(i);
  }
  if (std::abs(clipped - area_) > 1e-6 * std::abs(area_) + tolerance_) fail_crossing();
  return found;
}

// Twice the signed area of abc: positive when c lies left of ab.
double Outline::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const Vec2 ab = at(b) - at(a), ac = at(c) - at(a);
  return ab.x() * ac.y() - ab.y() * ac.x();
}
int Outline::side(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const double value = turn(a, b, c);
  return value > tolerance_ ? 1 : value < -tolerance_ ? -1 : 0;
}
double Outline::area(const Ring& ring) const {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += 0.5 * turn(ring[0], ring[i], ring[i + 1]);
  return sum;
}

// Repeated vertices dropped; counter-clockwise for sign 1, clockwise for -1 (files get holes wrong).
Outline::Ring Outline::oriented(const Ring& given, int sign) const {
  Ring ring;
  for (std::uint32_t v : given)
    if (ring.empty() || !same_place(ring.back(), v)) ring.push_back(v);
  while (ring.size() > 1 && same_place(ring.back(), ring.front())) ring.pop_back();
  if (area(ring) * sign < 0) std::reverse(ring.begin(), ring.end());
  return ring;
}

bool Outline::on_segment(std::uint32_t a, std::uint32_t b, std::uint32_t p) const {
  return side(a, b, p) == 0 && (at(p) - at(a)).dot(at(p) - at(b)) <= 0;
}

// Whether side pq blocks the diagonal ab: they cross, or an end of pq lies inside ab. Touching at the ends
// of ab is allowed, as bridges need it.
bool Outline::blocks(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b) const {
  for (std::uint32_t end : {p, q})
    if (!same_place(end, a) && !same_place(end, b) && on_segment(a, b, end)) return true;
  return side(a, b, p) * side(a, b, q) < 0 && side(p, q, a) * side(p, q, b) < 0;
}

void Outline::open_grid(std::size_t sides) {
  Vec2 low = at(ring_[0]), high = low;
  for (const std::uint32_t v : ring_) low = low.cwiseMin(at(v)), high = high.cwiseMax(at(v));
  grid_.open(low, high, sides);
}

// Whether `target` lies in the interior angle of the ring at position i.
bool Outline::opens_to(std::size_t i, std::uint32_t target) const {
  const std::uint32_t p = before(i), v = ring_[i], n = after(i);
  if (turn(p, v, n) >= 0) return turn(v, target, p) >= 0 && turn(v, n, target) >= 0;
  return !(turn(v, target, n) > 0 && turn(v, p, target) > 0);
}

// Holes from the right to the left, each joined at its rightmost vertex to the nearest vertex that sees it;
// one does, because the ray to the right meets only what is already joined.
void Outline::bridge_holes() {
  if (holes_.empty()) return;
  auto rightmost = [&](auto& hole) {
    return std::max_element(hole.begin(), hole.end(), [&](auto a, auto b) { return at(a).x() < at(b).x(); });
  };
  std::stable_sort(holes_.begin(), holes_.end(), [&](const Ring& a, const Ring& b) {
    return at(*rightmost(a)).x() > at(*rightmost(b)).x();
  });
  std::vector<Side> sides;
  open_grid(flat_.size());
  const auto add = [&](std::uint32_t from, std::uint32_t to) {
    grid_.add(static_cast<std::uint32_t>(sides.size()), at(from), at(to));
    sides.push_back({from, to});
  };
  const auto add_ring = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) add(ring[i], ring[(i + 1) % ring.size()]);
  };
  add_ring(ring_);
  for (const Ring& hole : holes_) add_ring(hole);
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    Ring hole = holes_[h];
    std::rotate(hole.begin(), rightmost(hole), hole.end());
    const std::size_t i = find_bridge(hole[0], sides);
    if (i == ring_.size())
      fail_input("face {}: hole {} does not lie inside the outline; correct the face in the model",
                 face_.name, h + 1);
    add(ring_[i], hole[0]);
    hole.push_back(hole[0]);
    hole.push_back(ring_[i]);
    ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(i) + 1, hole.begin(), hole.end());
  }
}

// Where in the ring the nearest vertex is that sees `from`; the ring's size when none does.
std::size_t Outline::find_bridge(std::uint32_t from, const std::vector<Side>& sides) const {
  std::vector<std::pair<double, std::size_t>> nearest;  // a heap, ties by their place
  for (std::size_t i = 0; i < ring_.size(); ++i)
    nearest.emplace_back((at(ring_[i]) - at(from)).squaredNorm(), i);
  std::make_heap(nearest.begin(), nearest.end(), std::greater<>());
  for (; !nearest.empty(); nearest.pop_back()) {
    std::pop_heap(nearest.begin(), nearest.end(), std::greater<>());
    const auto [length2, i] = nearest.back();
    const std::uint32_t to = ring_[i];
    if (!opens_to(i, from)) continue;
    const double margin = length2 > 0 ? tolerance_ / std::sqrt(length2) : 0;
    const Vec2 low = at(from).cwiseMin(at(to)).array() - margin,
               high = at(from).cwiseMax(at(to)).array() + margin;
    if (!grid_.any(low, high, [&](std::uint32_t s) { return blocks(sides[s][0], sides[s][1], to, from); }))
      return i;
  }
  return ring_.size();
}

// From here on every place of the ring, which bridges pass twice, has vertices of its own.
void Outline::begin_clipping() {
  const Ring passed = ring_;
  for (std::size_t i = 0; i < passed.size(); ++i) {
    flat_.push_back(at(passed[i]));
    model_vertex_.push_back(model_vertex_[passed[i]]);
    ring_[i] = static_cast<std::uint32_t>(flat_.size() - 1);
  }
  next_.assign(flat_.size(), kGone);
  for (std::size_t i = 0; i < ring_.size(); ++i) next_[ring_[i]] = after(i);
  obstacle_.assign(flat_.size(), {});
  open_grid(ring_.size());
  for (std::size_t i = 0; i < ring_.size(); ++i) grid_.add(ring_[i], at(ring_[i]), at(after(i)));
}

void Outline::drop(std::size_t i) {
  next_[before(i)] = after(i);
  grid_.add(before(i), at(before(i)), at(after(i)));
  next_[ring_[i]] = kGone;
  ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(i));
}

bool Outline::stands(const Obstacle& o) const {
  return o.first == kGone || (next_[o.first] != kGone && (o.second == kGone || next_[o.first] == o.second));
}

Outline::Obstacle Outline::find_obstacle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  if (side(a, b, c) <= 0) return {a, c, kGone, kGone};
  // Whatever has a say comes that near: within the triangle, but for what counts as on a side.
  const double shortest = std::min({(at(a) - at(b)).norm(), (at(b) - at(c)).norm(), (at(c) - at(a)).norm()});
  const double margin = tolerance_ / shortest;
  const Vec2 low = at(a).cwiseMin(at(b)).cwiseMin(at(c)).array() - margin,
             high = at(a).cwiseMax(at(b)).cwiseMax(at(c)).array() + margin;
  Obstacle found;
  grid_.any(low, high, [&](std::uint32_t p) {
    const std::uint32_t q = next_[p];
    if (q == kGone) return false;
    if (!same_place(p, a) && !same_place(p, b) && !same_place(p, c) && side(a, b, p) >= 0 &&
        side(b, c, p) >= 0 && side(c, a, p) >= 0) {
      found = {a, c, p, kGone};
      return true;
    }
    const Vec2 &from = at(p), &to = at(q);
    if (std::max(from.x(), to.x()) < low.x() || std::min(from.x(), to.x()) > high.x() ||
        std::max(from.y(), to.y()) < low.y() || std::min(from.y(), to.y()) > high.y() || !blocks(p, q, a, c))
      return false;
    found = {a, c, p, q};
    return true;
  });
  return found;
}

// The first vertex from `from` on, round the ring, that can be clipped; ring_.size() when none can. What kept
// a vertex from being an ear mostly still does.
std::size_t Outline::find_ear(std::size_t from) {
  for (std::size_t k = 0; k < ring_.size(); ++k) {
    const std::size_t i = (from + k) % ring_.size();
    Obstacle& known = obstacle_[ring_[i]];
    if (known.before == before(i) && known.after == after(i) && stands(known)) continue;
    known = find_obstacle(before(i), ring_[i], after(i));
    if (known.before == kGone) return i;
  }
  return ring_.size();
}

// Where the rest has no area: a vertex between collinear neighbours, or a spike.
bool Outline::drop_flat_vertex() {
  for (std::size_t i = 0; i < ring_.size(); ++i)
    if (side(before(i), ring_[i], after(i)) == 0) {
      drop(i);
      return true;
    }
  return false;
}

void Outline::fail_crossing() const {
  fail_input(
      "face {}: expected a simple outline with its holes inside, found one that crosses itself or a hole "
      "that leaves it; correct the face in the model",
      face_.name);
}

}  // namespace hybrid
