#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/polygon_model.hpp"

namespace hybrid {

// Which of a ring's sides come near a place: a grid of squares over the ring, each with the sides that cross
// it.
class SideGrid {
 public:
  // `count` sides are to be expected between the corners.
  void open(const Vec2& low, const Vec2& high, std::size_t count);
  void add(std::uint32_t side, const Vec2& from, const Vec2& to);

  // Calls visit(side) for what was added within the box, some more than once, until it returns true.
  template <typename Visit>
  bool any(const Vec2& low, const Vec2& high, const Visit& visit) const {
    for (std::size_t row = cell(low.y() - low_.y()); row <= cell(high.y() - low_.y()); ++row)
      for (std::size_t col = cell(low.x() - low_.x()); col <= cell(high.x() - low_.x()); ++col)
        for (const std::uint32_t side : cells_[row * width_ + col])
          if (visit(side)) return true;
    return false;
  }

 private:
  std::size_t cell(double along) const;

  Vec2 low_ = Vec2::Zero();
  double size_ = 1;
  std::size_t width_ = 1;  // and height
  std::vector<std::vector<std::uint32_t>> cells_;
};

// One face flattened to its plane. Positions are relative to the first vertex, counter-clockwise = front.
// Ear clipping with bridged holes, after Meisters (1975) and Eberly, "Triangulation by Ear Clipping". Every
// diagonal is tested against all sides near it: a test that looks only for vertices inside the ear goes wrong
// where bridges make the outline touch itself. The rings have at least three finite vertices each.
class Outline {
 public:
  // Throws what face_plane() throws.
  Outline(const PolygonModel& model, const Face& face);

  // Throws ErrorKind::input naming the face where its rings cross or a hole lies outside.
  std::vector<std::array<std::uint32_t, 3>> triangles();

  // The outer ring with every hole joined to it; the ends of what joins them occur twice. Throws as
  // triangles().
  std::vector<std::uint32_t> bridged();

 private:
  using Ring = std::vector<std::uint32_t>;
  using Side = std::array<std::uint32_t, 2>;
  static constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

  // Why a vertex was no ear when its neighbours were these: no corner, a vertex inside, or a side that
  // blocks.
  struct Obstacle {
    std::uint32_t before = kGone, after = kGone;
    std::uint32_t first = kGone, second = kGone;  // a side; a vertex alone; none: no corner
  };

  const Vec2& at(std::uint32_t vertex) const { return flat_[vertex]; }
  std::uint32_t before(std::size_t i) const { return ring_[(i + ring_.size() - 1) % ring_.size()]; }
  std::uint32_t after(std::size_t i) const { return ring_[(i + 1) % ring_.size()]; }
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  int side(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  bool same_place(std::uint32_t a, std::uint32_t b) const { return a == b || at(a) == at(b); }
  double area(const Ring& ring) const;
  Ring flatten(const PolygonModel& model, const Ring& ring, const Vec3& u, const Vec3& v, int sign);
  Ring oriented(const Ring& given, int sign) const;
  bool on_segment(std::uint32_t a, std::uint32_t b, std::uint32_t p) const;
  bool blocks(std::uint32_t p, std::uint32_t q, std::uint32_t a, std::uint32_t b) const;
  void open_grid(std::size_t sides);
  bool opens_to(std::size_t i, std::uint32_t target) const;
  void bridge_holes();
  std::size_t find_bridge(std::uint32_t from, const std::vector<Side>& sides) const;
  void begin_clipping();
  void drop(std::size_t i);
  bool stands(const Obstacle& obstacle) const;
  Obstacle find_obstacle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  std::size_t find_ear(std::size_t from);
  bool drop_flat_vertex();
  [[noreturn]] void fail_crossing() const;

  const Face& face_;
  // Rings hold positions in these two: the face's own vertices, outline first.
  std::vector<Vec2> flat_;
  Ring model_vertex_;
  Ring ring_;
  std::vector<Ring> holes_;
  // While ears are clipped, per vertex: the next one in the ring, or kGone; why it was no ear.
  Ring next_;
  std::vector<Obstacle> obstacle_;
  SideGrid grid_;  // of the sides, by their first vertex; of some that are no more, too
  double area_ = 0, tolerance_ = 0;
};

}  // namespace hybrid
