#pragma once
#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "geometry/flat_ring.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"

namespace hybrid::stages {

// METHOD 9: shapes that scans are clipped by, in a frame that the caller chooses.
struct ClipBox {
  Vec3 low, high;
  bool holds(const Vec3& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};
struct ClipHalfSpace {  // normal . x <= offset
  Vec3 normal;
  double offset_m;
  bool holds(const Vec3& p) const { return normal.dot(p) <= offset_m; }
};
struct ClipPrism {  // over a polygon of x, y
  Ring2 polygon;
  double low, high;
  bool holds(const Vec3& p) const {
    return p.z() >= low && p.z() <= high && inside(polygon, Vec2(p.x(), p.y()));
  }
};
using ClipShape = std::variant<ClipBox, ClipHalfSpace, ClipPrism>;
inline bool holds(const ClipShape& shape, const Vec3& p) {
  return std::visit([&](const auto& s) { return s.holds(p); }, shape);
}

// Marks (1) the measured nodes that the clip drops, in `clipped` (one per node); returns how many that had
// not been. The points are taken into the shape's frame first.
std::int64_t clip_nodes(const RangeImage& image, const Pose& shape_from_scan, const ClipShape& shape,
                        bool keep_inside, std::vector<std::uint8_t>& clipped);

// Moves the measured nodes inside a simple polygon of the grid (rows and columns; nodes on its border take
// part) along their rays by `by_m`, away from the scanner positive; returns which (1 per node). Throws
// ErrorKind::input: a polygon that leaves the grid, a node that would come to lie at or behind the scanner.
std::vector<std::uint8_t> move_area(RangeImage& image, const std::vector<std::array<int, 2>>& polygon,
                                    double by_m);

// Which points (scan frame; indices, ascending) lie towards nodes of such a polygon.
std::vector<std::size_t> points_in_area(const RangeImage& image, const std::vector<Vec3>& points,
                                        const std::vector<std::array<int, 2>>& polygon);

}  // namespace hybrid::stages
