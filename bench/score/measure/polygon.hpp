#pragma once
#include <vector>

#include "score/geometry.hpp"

namespace score {

// Rings in one plane; inside by the even-odd rule, so that inner rings are holes and keyholed polygons work.
class PlanePolygon {
 public:
  PlanePolygon(const Plane& plane, const std::vector<std::vector<Vec3>>& rings);

  bool covers(const Vec3& point) const { return covers(flat(point)); }  // along the normal
  double distance_m(
      const Vec3& point) const;  // to the polygon in space: along the normal or to the nearest edge

 private:
  struct Edge {
    Vec2 a, b;
  };
  Vec2 flat(const Vec3& point) const { return {axes_[0].dot(point), axes_[1].dot(point)}; }
  bool covers(const Vec2& point) const;
  std::size_t strip_of(double y) const;
  double edge_distance_m(const Vec2& point) const;

  Plane plane_;
  std::array<Vec3, 2> axes_;
  std::vector<Edge> edges_;
  double low_ = 0, high_ = 0;                       // of y
  std::vector<std::vector<std::uint32_t>> strips_;  // edges by the strips of y they cross
};

}  // namespace score
