#pragma once
#include <utility>
#include <vector>

#include "geometry/flat_ring.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid::stages {

// One face of a model by its corners.
struct SpacePolygon {
  std::vector<Vec3> outer;
  std::vector<std::vector<Vec3>> holes;
};

SpacePolygon polygon_of(const PolygonModel& model, const Face& face);
PolygonModel model_of(const SpacePolygon& polygon);  // of one face without a name

// What a polygon lies in.
struct PolygonBox {
  Vec3 low, high;
  explicit PolygonBox(const SpacePolygon& polygon);
  bool is_near(const PolygonBox& other, double distance_m) const;
};

// A polygon on its plane, in coordinates of which the second goes up as steeply as it can there; on a level
// plane they follow the outer ring's longest edge.
class FlatPolygon {
 public:
  explicit FlatPolygon(const SpacePolygon& polygon);
  // The second coordinate along a direction on its plane, or nearly.
  FlatPolygon(const SpacePolygon& polygon, const Vec3& second);

  Vec2 flat(const Vec3& point) const { return {u_.dot(point - origin_), v_.dot(point - origin_)}; }
  Vec3 lifted(const Vec2& at) const { return origin_ + at.x() * u_ + at.y() * v_; }
  const Vec2& low() const { return low_; }
  const Vec2& high() const { return high_; }
  bool is_level() const { return is_level_; }
  const Vec3& normal() const { return normal_; }

  bool holds(const Vec2& at) const;
  bool covers(const Vec3& place, double tolerance_m) const;  // lies on it
  // On a grid over it, `step_m` apart, but no more than `most_steps` across.
  std::vector<Vec3> places(double step_m, int most_steps) const;
  // Where a line of constant second coordinate is inside, from and to, ascending.
  std::vector<std::pair<double, double>> spans(double y) const;

 private:
  void find_axes(const std::vector<Vec3>& ring);
  void flatten(const SpacePolygon& polygon);

  Vec3 origin_, normal_ = Vec3::Zero(), u_, v_;
  bool is_level_ = false;
  Ring2 outer_;
  std::vector<Ring2> holes_;
  Vec2 low_, high_;  // of the outer ring
};

}  // namespace hybrid::stages
