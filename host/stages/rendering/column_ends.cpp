#include "stages/rendering/column_ends.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/flat_ring.hpp"

namespace hybrid::stages {
namespace {

constexpr double kEndReach = 2.5, kInwards = 0.3;            // radii from an end, along the axis
constexpr double kNearestSide = 1.7, kFarthestCorner = 2.5;  // radii from the axis
constexpr double kPlaces_m = 0.03;                           // of the places that are asked about
constexpr int kMostSteps = 16;                               // across a polygon
constexpr double kMostEmpty = 0.1, kLeastUnknown = 0.25;     // of them
constexpr double kSamePlane_m = 0.02;

struct Polygon {
  std::vector<Vec3> outer;
  std::vector<std::vector<Vec3>> holes;
};

// A polygon on its plane.
class FlatPolygon {
 public:
  explicit FlatPolygon(const Polygon& polygon) : origin_(polygon.outer[0]) {
    for (std::size_t k = 0; k < polygon.outer.size(); ++k)
      normal_ +=
          (polygon.outer[k] - origin_).cross(Vec3(polygon.outer[(k + 1) % polygon.outer.size()] - origin_));
    normal_.normalize();
    u_ = normal_.unitOrthogonal();
    v_ = normal_.cross(u_);
    for (const Vec3& point : polygon.outer) outer_.push_back(flat(point));
    for (const auto& hole : polygon.holes) {
      holes_.emplace_back();
      for (const Vec3& point : hole) holes_.back().push_back(flat(point));
    }
  }
  bool holds(const Vec2& at) const {
    return inside(outer_, at) &&
           std::none_of(holes_.begin(), holes_.end(), [&](const Ring2& hole) { return inside(hole, at); });
  }
  bool covers(const Vec3& place) const {
    return std::abs(normal_.dot(place - origin_)) <= kSamePlane_m && holds(flat(place));
  }
  // On a grid over it.
  std::vector<Vec3> places() const {
    Vec2 low = outer_[0], high = outer_[0];
    for (const Vec2& point : outer_) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const double step = std::max(kPlaces_m, (high - low).maxCoeff() / kMostSteps);
    std::vector<Vec3> found;
    for (double y = low.y() + step / 2; y < high.y(); y += step)
      for (double x = low.x() + step / 2; x < high.x(); x += step)
        if (holds({x, y})) found.push_back(origin_ + x * u_ + y * v_);
    return found;
  }

 private:
  Vec2 flat(const Vec3& point) const { return {u_.dot(point - origin_), v_.dot(point - origin_)}; }

  Vec3 origin_, normal_ = Vec3::Zero(), u_, v_;
  Ring2 outer_;
  std::vector<Ring2> holes_;
};

bool is_same(const Cylinder& a, const Cylinder& b) {
  const Vec3 middle = a.foot + 0.5 * a.length_m * a.axis;
  return b.outwards(middle).norm() < 0.5 * std::min(a.radius_m, b.radius_m) && b.along(middle) >= 0 &&
         b.along(middle) <= b.length_m;
}

// Of its base or its head.
bool is_of_end(const Polygon& polygon, const Cylinder& column) {
  const Vec3 a = column.axis.unitOrthogonal(), b = column.axis.cross(a);
  Ring2 around;  // seen along the axis, which is at 0
  double low = column.along(polygon.outer[0]), high = low, farthest = 0;
  for (const Vec3& point : polygon.outer) {
    const Vec3 out = column.outwards(point);
    around.emplace_back(out.dot(a), out.dot(b));
    farthest = std::max(farthest, around.back().norm());
    low = std::min(low, column.along(point));
    high = std::max(high, column.along(point));
  }
  const double radius = column.radius_m, length = column.length_m;
  const bool base = low >= -kEndReach * radius && high <= kInwards * radius;
  const bool head = low >= length - kInwards * radius && high <= length + kEndReach * radius;
  return (base || head) && farthest <= kFarthestCorner * radius &&
         distance_to_border(around, Vec2::Zero()) <= kNearestSide * radius;
}

Polygon turned(const Polygon& polygon, const Cylinder& about, int quarters) {
  const Mat3 turn = Eigen::AngleAxisd(quarters * std::numbers::pi / 2, about.axis).toRotationMatrix();
  Polygon copy = polygon;
  const auto move = [&](Vec3& point) { point = about.foot + turn * (point - about.foot); };
  std::for_each(copy.outer.begin(), copy.outer.end(), move);
  for (auto& hole : copy.holes) std::for_each(hole.begin(), hole.end(), move);
  return copy;
}

// Whether enough of it is new, and little of it seen to be empty.
bool may_be_there(const ScanSight& sight, const FlatPolygon& polygon,
                  const std::vector<FlatPolygon>& others) {
  const auto places = polygon.places();
  std::size_t empty = 0, unknown = 0;
  for (const Vec3& place : places)
    if (sight.is_empty(place))
      ++empty;
    else if (!sight.is_known(place) &&
             std::none_of(others.begin(), others.end(),
                          [&](const FlatPolygon& other) { return other.covers(place); }))
      ++unknown;
  const auto all = static_cast<double>(places.size());
  return !places.empty() && static_cast<double>(empty) <= kMostEmpty * all &&
         static_cast<double>(unknown) >= kLeastUnknown * all;
}

PolygonModel model_of(const Polygon& polygon) {
  PolygonModel model;
  const auto add = [&](const std::vector<Vec3>& ring) {
    std::vector<std::uint32_t> vertices;
    for (const Vec3& point : ring) {
      vertices.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(point);
    }
    return vertices;
  };
  model.faces = {{"", add(polygon.outer), {}}};
  for (const auto& hole : polygon.holes) model.faces[0].holes.push_back(add(hole));
  return model;
}

Polygon polygon_of(const PolygonModel& model, const Face& face) {
  Polygon polygon;
  for (const std::uint32_t vertex : face.outer) polygon.outer.push_back(model.vertices[vertex]);
  for (const auto& hole : face.holes) {
    polygon.holes.emplace_back();
    for (const std::uint32_t vertex : hole) polygon.holes.back().push_back(model.vertices[vertex]);
  }
  return polygon;
}

}  // namespace

std::vector<ColumnEnd> column_ends(const ScanSight& sight, const PolygonModel& contours) {
  std::vector<ColumnEnd> ends;
  std::vector<Cylinder> done;
  for (const auto& [scan, column] : sight.columns()) {
    const auto is_done = [&column = column](const Cylinder& other) { return is_same(column, other); };
    if (std::any_of(done.begin(), done.end(), is_done)) continue;
    done.push_back(column);
    std::vector<FlatPolygon> copies;
    for (const Face& face : contours.faces) {
      const Polygon polygon = polygon_of(contours, face);
      if (!is_of_end(polygon, column)) continue;
      for (const int quarters : {1, 2, 3}) {
        const Polygon copy = turned(polygon, column, quarters);
        const FlatPolygon flat(copy);
        PolygonModel model = model_of(copy);
        if (!may_be_there(sight, flat, copies) || !can_be_triangulated(model)) continue;
        copies.push_back(flat);
        ends.push_back({scan, column.id, std::move(model)});
      }
    }
  }
  return ends;
}

}  // namespace hybrid::stages
