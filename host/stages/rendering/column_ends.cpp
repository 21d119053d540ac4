#include "stages/rendering/column_ends.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/flat_ring.hpp"
#include "stages/rendering/column_squares.hpp"
#include "stages/rendering/flat_polygon.hpp"
#include "stages/rendering/unseen_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kEndReach = 2.5, kInwards = 0.3;            // radii from an end, along the axis
constexpr double kNearestSide = 1.7, kFarthestCorner = 2.5;  // radii from the axis
constexpr double kAlikeReach = 4;                            // radii from an end: its own may be hidden

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

template <typename Move>
SpacePolygon each_moved(SpacePolygon polygon, const Move& move) {
  const auto each = [&](std::vector<Vec3>& ring) {
    for (Vec3& point : ring) point = move(point);
  };
  each(polygon.outer);
  std::for_each(polygon.holes.begin(), polygon.holes.end(), each);
  return polygon;
}

SpacePolygon turned(const SpacePolygon& polygon, const Cylinder& about, int quarters) {
  const Mat3 turn = Eigen::AngleAxisd(quarters * std::numbers::pi / 2, about.axis).toRotationMatrix();
  return each_moved(polygon,
                    [&](const Vec3& point) { return Vec3(about.foot + turn * (point - about.foot)); });
}

// What was seen at one end of a column.
struct SeenEnd {
  std::vector<SpacePolygon> polygons, squares;
};

std::vector<SeenEnd> seen_ends(const std::vector<SightColumn>& columns, ColumnEndKind end,
                               const PolygonModel& contours) {
  std::vector<SeenEnd> ends(columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    for (const Face& face : contours.faces)
      if (SpacePolygon polygon = polygon_of(contours, face); end_of(polygon, columns[k].cylinder) == end)
        ends[k].polygons.push_back(std::move(polygon));
    ends[k].squares = column_squares(columns[k].cylinder, end, ends[k].polygons);
  }
  return ends;
}

// The squares of the nearest column of the same design that has some, at the same height.
std::vector<SpacePolygon> squares_of_alike(const std::vector<SightColumn>& columns,
                                           const std::vector<SeenEnd>& ends, std::size_t column) {
  const Cylinder& own = columns[column].cylinder;
  const auto apart = [&](std::size_t k) { return own.outwards(columns[k].cylinder.foot); };
  std::optional<std::size_t> nearest;
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (k != column && !ends[k].squares.empty() && is_alike(own, columns[k].cylinder) &&
        (!nearest || apart(k).norm() < apart(*nearest).norm()))
      nearest = k;
  if (!nearest) return {};
  std::vector<SpacePolygon> squares;
  for (const SpacePolygon& square : ends[*nearest].squares)
    squares.push_back(
        each_moved(square, [away = apart(*nearest)](const Vec3& point) { return Vec3(point - away); }));
  std::erase_if(squares, [&](const SpacePolygon& square) {
    return std::any_of(square.outer.begin(), square.outer.end(), [&](const Vec3& point) {
      const double along = own.along(point), beyond = std::max(-along, along - own.length_m);
      return beyond < 0 || beyond > kAlikeReach * own.radius_m;
    });
  });
  return squares;
}

}  // namespace

std::vector<ColumnEnd> column_ends(const ScanSight& sight, const PolygonModel& contours) {
  std::vector<SightColumn> columns;
  for (const SightColumn& column : sight.columns())
    if (std::none_of(columns.begin(), columns.end(),
                     [&](const SightColumn& other) { return is_same(column.cylinder, other.cylinder); }))
      columns.push_back(column);
  const std::array ends = {seen_ends(columns, ColumnEndKind::kBase, contours),
                           seen_ends(columns, ColumnEndKind::kHead, contours)};
  std::vector<ColumnEnd> all;
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const auto& end : ends) {
      std::vector<FlatPolygon> there;
      for (const SpacePolygon& polygon : end[k].polygons) there.emplace_back(polygon);
      const auto add = [&](const SpacePolygon& polygon) {
        const FlatPolygon flat(polygon);
        PolygonModel model = model_of(polygon);
        if (!may_be_there(sight, flat, there) || !can_be_triangulated(model)) return;
        there.push_back(flat);
        all.push_back({columns[k].scan, columns[k].cylinder.id, std::move(model)});
      };
      for (const SpacePolygon& square :
           end[k].squares.empty() ? squares_of_alike(columns, end, k) : end[k].squares)
        add(square);
      for (const SpacePolygon& polygon : end[k].polygons)
        for (const int quarters : {1, 2, 3}) add(turned(polygon, columns[k].cylinder, quarters));
    }
  return all;
}

}  // namespace hybrid::stages
