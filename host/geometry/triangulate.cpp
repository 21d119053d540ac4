// Ear clipping with bridged holes, after Meisters (1975) and Eberly, "Triangulation by Ear Clipping". Every
// diagonal is tested against the whole outline: proxies have few vertices per face, and a test that looks
// only for vertices inside the ear goes wrong where bridges make the outline touch itself.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid {
namespace {

using Ring = std::vector<std::uint32_t>;

// Twice the area times the normal, about the ring's first vertex: far origins cost no digits.
Vec3 newell(const PolygonModel& model, const Ring& ring) {
  Vec3 sum = Vec3::Zero();
  if (ring.empty()) return sum;
  const Vec3 base = model.vertices[ring[0]];
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    sum += (model.vertices[ring[i]] - base).cross(model.vertices[ring[i + 1]] - base);
  return sum;
}

double extent_m(const PolygonModel& model, const Ring& ring) {
  double extent = 0;
  for (std::uint32_t v : ring)
    extent = std::max(extent, (model.vertices[v] - model.vertices[ring[0]]).norm());
  return extent;
}

void check_ring(const PolygonModel& model, const Face& face, const Ring& ring, const char* what) {
  if (ring.size() < 3)
    fail_input("face {}: expected at least 3 vertices in its {}, found {}", face.name, what, ring.size());
  for (std::uint32_t v : ring) {
    if (v >= model.vertices.size())
      fail_input("face {}: vertex index {} in its {}, but the model has {} vertices", face.name, v, what,
                 model.vertices.size());
    if (!model.vertices[v].allFinite())
      fail_input("face {}: vertex {} of its {} is not finite", face.name, v, what);
  }
}

// One face flattened to its plane. Positions are relative to the first vertex, counter-clockwise = front.
class Outline {
 public:
  Outline(const PolygonModel& model, const Face& face) : face_(face) {
    const Vec3 normal = face_plane(model, face).normal;
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    const Vec3 base = model.vertices[face.outer[0]];
    auto flatten = [&](const Ring& ring, int sign) {
      Ring own;
      for (std::uint32_t index : ring) {
        const Vec3 arm = model.vertices[index] - base;
        own.push_back(static_cast<std::uint32_t>(flat_.size()));
        flat_.emplace_back(arm.dot(u), arm.dot(v));
        model_vertex_.push_back(index);
      }
      return oriented(own, sign);
    };
    const double size = extent_m(model, face.outer);
    tolerance_ = 1e-12 * size * size;
    ring_ = flatten(face.outer, 1);
    for (const Ring& hole : face.holes) holes_.push_back(flatten(hole, -1));
    area_ = area(ring_);
    for (const Ring& hole : holes_) area_ += area(hole);
  }

  std::vector<std::array<std::uint32_t, 3>> triangles() {
    bridge_holes();
    begin_clipping();
    std::vector<std::array<std::uint32_t, 3>> found;
    double clipped = 0;
    while (ring_.size() >= 3) {
      const std::size_t i = find_ear();
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

 private:
  const Vec2& at(std::uint32_t vertex) const { return flat_[vertex]; }
  std::uint32_t before(std::size_t i) const { return ring_[(i + ring_.size() - 1) % ring_.size()]; }
  std::uint32_t after(std::size_t i) const { return ring_[(i + 1) % ring_.size()]; }

  // Twice the signed area of abc: positive when c lies left of ab.
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec2 ab = at(b) - at(a), ac = at(c) - at(a);
    return ab.x() * ac.y() - ab.y() * ac.x();
  }
  int side(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const double value = turn(a, b, c);
    return value > tolerance_ ? 1 : value < -tolerance_ ? -1 : 0;
  }
  bool same_place(std::uint32_t a, std::uint32_t b) const { return a == b || at(a) == at(b); }

  double area(const Ring& ring) const {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += 0.5 * turn(ring[0], ring[i], ring[i + 1]);
    return sum;
  }

  // Repeated vertices dropped; counter-clockwise for sign 1, clockwise for -1 (files get holes wrong).
  Ring oriented(const Ring& given, int sign) const {
    Ring ring;
    for (std::uint32_t v : given)
      if (ring.empty() || !same_place(ring.back(), v)) ring.push_back(v);
    while (ring.size() > 1 && same_place(ring.back(), ring.front())) ring.pop_back();
    if (area(ring) * sign < 0) std::reverse(ring.begin(), ring.end());
    return ring;
  }

  bool on_segment(std::uint32_t a, std::uint32_t b, std::uint32_t p) const {
    return side(a, b, p) == 0 && (at(p) - at(a)).dot(at(p) - at(b)) <= 0;
  }

  // Whether side pq blocks the diagonal ab: they cross, or an end of pq lies inside ab. Touching at the ends
  // of ab is allowed, as bridges need it.
  bool blocks(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b) const {
    for (std::uint32_t end : {p, q})
      if (!same_place(end, a) && !same_place(end, b) && on_segment(a, b, end)) return true;
    return side(a, b, p) * side(a, b, q) < 0 && side(p, q, a) * side(p, q, b) < 0;
  }
  bool ring_blocks(const Ring& ring, std::uint32_t a, std::uint32_t b) const {
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (blocks(ring[i], ring[(i + 1) % ring.size()], a, b)) return true;
    return false;
  }

  // Whether `target` lies in the interior angle of the ring at position i.
  bool opens_to(std::size_t i, std::uint32_t target) const {
    const std::uint32_t p = before(i), v = ring_[i], n = after(i);
    if (turn(p, v, n) >= 0) return turn(v, target, p) >= 0 && turn(v, n, target) >= 0;
    return !(turn(v, target, n) > 0 && turn(v, p, target) > 0);
  }

  // Holes from the right to the left, each joined at its rightmost vertex to the nearest vertex that sees it;
  // one does, because the ray to the right meets only what is already joined.
  void bridge_holes() {
    auto rightmost = [&](auto& hole) {
      return std::max_element(hole.begin(), hole.end(),
                              [&](auto a, auto b) { return at(a).x() < at(b).x(); });
    };
    std::stable_sort(holes_.begin(), holes_.end(), [&](const Ring& a, const Ring& b) {
      return at(*rightmost(a)).x() > at(*rightmost(b)).x();
    });
    for (std::size_t h = 0; h < holes_.size(); ++h) {
      Ring hole = holes_[h];
      std::rotate(hole.begin(), rightmost(hole), hole.end());
      const std::size_t i = find_bridge(hole[0], h);
      hole.push_back(hole[0]);
      hole.push_back(ring_[i]);
      ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(i) + 1, hole.begin(), hole.end());
    }
  }

  std::size_t find_bridge(std::uint32_t from, std::size_t first_hole) const {
    std::vector<std::size_t> order(ring_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    auto distance2 = [&](std::size_t i) { return (at(ring_[i]) - at(from)).squaredNorm(); };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return distance2(a) < distance2(b); });
    for (std::size_t i : order) {
      if (!opens_to(i, from) || ring_blocks(ring_, ring_[i], from)) continue;
      const bool hole_between =
          std::any_of(holes_.begin() + static_cast<std::ptrdiff_t>(first_hole), holes_.end(),
                      [&](const Ring& hole) { return ring_blocks(hole, ring_[i], from); });
      if (!hole_between) return i;
    }
    fail_input("face {}: hole {} does not lie inside the outline; correct the face in the model", face_.name,
               first_hole + 1);
  }

  // From here on every place of the ring, which bridges pass twice, has vertices of its own.
  void begin_clipping() {
    const Ring passed = ring_;
    for (std::size_t i = 0; i < passed.size(); ++i) {
      flat_.push_back(at(passed[i]));
      model_vertex_.push_back(model_vertex_[passed[i]]);
      ring_[i] = static_cast<std::uint32_t>(flat_.size() - 1);
    }
    next_.assign(flat_.size(), kGone);
    for (std::size_t i = 0; i < ring_.size(); ++i) next_[ring_[i]] = after(i);
    obstacle_.assign(flat_.size(), {});
  }

  void drop(std::size_t i) {
    next_[before(i)] = after(i);
    next_[ring_[i]] = kGone;
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  // Why a vertex was no ear when its neighbours were these: no corner, a vertex inside, or a side that
  // blocks.
  struct Obstacle {
    std::uint32_t before = kGone, after = kGone;
    std::uint32_t first = kGone, second = kGone;  // a side; a vertex alone; none: no corner
  };
  bool stands(const Obstacle& o) const {
    return o.first == kGone || (next_[o.first] != kGone && (o.second == kGone || next_[o.first] == o.second));
  }

  Obstacle find_obstacle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (side(a, b, c) <= 0) return {a, c, kGone, kGone};
    for (const std::uint32_t v : ring_)
      if (!same_place(v, a) && !same_place(v, b) && !same_place(v, c) && side(a, b, v) >= 0 &&
          side(b, c, v) >= 0 && side(c, a, v) >= 0)
        return {a, c, v, kGone};
    // A side that blocks comes within half the diagonal's length of its middle.
    const Vec2 middle = 0.5 * (at(a) + at(c));
    const double reach = 0.5 * (at(a) - at(c)).norm() * (1 + 1e-9) + std::sqrt(tolerance_) * 1e-3;
    const Vec2 low = middle.array() - reach, high = middle.array() + reach;
    for (const std::uint32_t p : ring_) {
      const std::uint32_t q = next_[p];
      const Vec2 &from = at(p), &to = at(q);
      if (std::max(from.x(), to.x()) < low.x() || std::min(from.x(), to.x()) > high.x() ||
          std::max(from.y(), to.y()) < low.y() || std::min(from.y(), to.y()) > high.y())
        continue;
      if (blocks(p, q, a, c)) return {a, c, p, q};
    }
    return {};
  }

  // The first vertex that can be clipped; ring_.size() when none can. What kept a vertex from being an ear
  // mostly still does.
  std::size_t find_ear() {
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      Obstacle& known = obstacle_[ring_[i]];
      if (known.before == before(i) && known.after == after(i) && stands(known)) continue;
      known = find_obstacle(before(i), ring_[i], after(i));
      if (known.before == kGone) return i;
    }
    return ring_.size();
  }

  // Where the rest has no area: a vertex between collinear neighbours, or a spike.
  bool drop_flat_vertex() {
    for (std::size_t i = 0; i < ring_.size(); ++i)
      if (side(before(i), ring_[i], after(i)) == 0) {
        drop(i);
        return true;
      }
    return false;
  }

  [[noreturn]] void fail_crossing() const {
    fail_input(
        "face {}: expected a simple outline with its holes inside, found one that crosses itself or a hole "
        "that leaves it; correct the face in the model",
        face_.name);
  }

  const Face& face_;
  // Rings hold positions in these two: the face's own vertices, outline first.
  std::vector<Vec2> flat_;
  Ring model_vertex_;
  Ring ring_;
  std::vector<Ring> holes_;
  // While ears are clipped, per vertex: the next one in the ring, or kGone; why it was no ear.
  static constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();
  Ring next_;
  std::vector<Obstacle> obstacle_;
  double area_ = 0, tolerance_ = 0;
};

}  // namespace

Plane face_plane(const PolygonModel& model, const Face& face) {
  check_ring(model, face, face.outer, "outline");
  const Vec3 twice_area = newell(model, face.outer);
  const double size = extent_m(model, face.outer);
  // 1e-9 of the square around it: what is left of a metre-sized face in a file with 6 digits is a thousand
  // times more.
  if (!(twice_area.norm() > 1e-9 * size * size))
    fail_input(
        "face {}: expected a polygon with an area, found {} vertices on one point or line; remove the face "
        "from the model",
        face.name, face.outer.size());
  Vec3 centre = Vec3::Zero();
  for (std::uint32_t v : face.outer) centre += (model.vertices[v] - model.vertices[face.outer[0]]);
  centre = model.vertices[face.outer[0]] + centre / static_cast<double>(face.outer.size());
  const Vec3 normal = twice_area.normalized();
  return {normal, normal.dot(centre)};
}

double face_area_m2(const PolygonModel& model, const Face& face) {
  const Vec3 normal = face_plane(model, face).normal;
  double area = 0.5 * newell(model, face.outer).norm();
  for (const Ring& hole : face.holes) {
    check_ring(model, face, hole, "hole");
    area -= 0.5 * std::abs(newell(model, hole).dot(normal));
  }
  return area;
}

std::vector<Triangle> triangulate(const PolygonModel& model) {
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const Face& face = model.faces[f];
    check_ring(model, face, face.outer, "outline");
    for (const Ring& hole : face.holes) check_ring(model, face, hole, "hole");
    if (face.outer.size() == 3 && face.holes.empty()) {  // as the general way has it
      face_plane(model, face);                           // throws without an area
      triangles.push_back({{face.outer[2], face.outer[0], face.outer[1]}, static_cast<std::uint32_t>(f)});
      continue;
    }
    for (const auto& corners : Outline(model, face).triangles())
      triangles.push_back({corners, static_cast<std::uint32_t>(f)});
  }
  return triangles;
}

bool can_be_triangulated(const PolygonModel& model) {
  try {
    triangulate(model);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace hybrid
