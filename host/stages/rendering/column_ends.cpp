#include "stages/rendering/column_ends.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/flat_ring.hpp"
#include "stages/rendering/column_squares.hpp"
#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kEndReach = 2.5, kInwards = 0.3;            // radii from an end, along the axis
constexpr double kNearestSide = 1.7, kFarthestCorner = 2.5;  // radii from the axis
constexpr double kPlaces_m = 0.03;                           // of the places that are asked about
constexpr int kMostSteps = 16;                               // across a polygon
constexpr double kMostEmpty = 0.1, kLeastUnknown = 0.25;     // of them
constexpr double kSamePlane_m = 0.02;

ColumnEndKind end_of(const SpacePolygon& polygon, const Cylinder& column) {
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
  if (farthest > kFarthestCorner * radius || distance_to_border(around, Vec2::Zero()) > kNearestSide * radius)
    return ColumnEndKind::kNone;
  return base ? ColumnEndKind::kBase : head ? ColumnEndKind::kHead : ColumnEndKind::kNone;
}

SpacePolygon turned(const SpacePolygon& polygon, const Cylinder& about, int quarters) {
  const Mat3 turn = Eigen::AngleAxisd(quarters * std::numbers::pi / 2, about.axis).toRotationMatrix();
  SpacePolygon copy = polygon;
  const auto move = [&](Vec3& point) { point = about.foot + turn * (point - about.foot); };
  std::for_each(copy.outer.begin(), copy.outer.end(), move);
  for (auto& hole : copy.holes) std::for_each(hole.begin(), hole.end(), move);
  return copy;
}

// Whether enough of it is new, and little of it seen to be empty.
bool may_be_there(const ScanSight& sight, const FlatPolygon& polygon,
                  const std::vector<FlatPolygon>& others) {
  const auto places = polygon.places(kPlaces_m, kMostSteps);
  std::size_t empty = 0, unknown = 0;
  for (const Vec3& place : places)
    if (sight.is_empty(place))
      ++empty;
    else if (!sight.is_known(place) &&
             std::none_of(others.begin(), others.end(),
                          [&](const FlatPolygon& other) { return other.covers(place, kSamePlane_m); }))
      ++unknown;
  const auto all = static_cast<double>(places.size());
  return !places.empty() && static_cast<double>(empty) <= kMostEmpty * all &&
         static_cast<double>(unknown) >= kLeastUnknown * all;
}

}  // namespace

std::vector<ColumnEnd> column_ends(const ScanSight& sight, const PolygonModel& contours) {
  std::vector<ColumnEnd> ends;
  std::vector<Cylinder> done;
  for (const auto& [scan, column] : sight.columns()) {
    const auto is_done = [&column = column](const Cylinder& other) { return is_same(column, other); };
    if (std::any_of(done.begin(), done.end(), is_done)) continue;
    done.push_back(column);
    std::vector<FlatPolygon> there;
    const auto add = [&, scan = scan, id = column.id](const SpacePolygon& polygon) {
      const FlatPolygon flat(polygon);
      PolygonModel model = model_of(polygon);
      if (!may_be_there(sight, flat, there) || !can_be_triangulated(model)) return;
      there.push_back(flat);
      ends.push_back({scan, id, std::move(model)});
    };
    for (const ColumnEndKind end : {ColumnEndKind::kBase, ColumnEndKind::kHead}) {
      std::vector<SpacePolygon> seen;
      for (const Face& face : contours.faces)
        if (SpacePolygon polygon = polygon_of(contours, face); end_of(polygon, column) == end)
          seen.push_back(std::move(polygon));
      there.clear();
      for (const SpacePolygon& polygon : seen) there.emplace_back(polygon);
      for (const SpacePolygon& polygon : column_squares(column, end, seen)) add(polygon);
      for (const SpacePolygon& polygon : seen)
        for (const int quarters : {1, 2, 3}) add(turned(polygon, column, quarters));
    }
  }
  return ends;
}

}  // namespace hybrid::stages
