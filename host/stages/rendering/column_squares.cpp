#include "stages/rendering/column_squares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace hybrid::stages {
namespace {

constexpr double kSideUpright = 0.1;    // of a side's normal, along the axis
constexpr double kReachesCorner = 0.8;  // of half the width: the sides of an octagon do not
constexpr double kPastCorner_m = 0.03;
constexpr double kSameWidth_m = 0.02;
constexpr double kSameTurn_rad = 0.07;
constexpr int kShaftCorners = 24;
constexpr double kQuarter = std::numbers::pi / 2;

// Square about an axis.
struct Square {
  double turn_rad;       // of a side's outward normal, from the axis' first perpendicular; in [0, a quarter)
  double half_m;         // of the width
  double low_m, high_m;  // along the axis
  double area_m2;        // of the sides that say so
};

// The axis' two perpendiculars.
struct Around {
  Vec3 a, b;
  explicit Around(const Cylinder& column) : a(column.axis.unitOrthogonal()), b(column.axis.cross(a)) {}
  Vec3 towards(double turn_rad) const { return std::cos(turn_rad) * a + std::sin(turn_rad) * b; }
};

std::optional<Square> square_of(const Cylinder& column, const Around& around, const SpacePolygon& side) {
  const FlatPolygon flat(side);
  const Vec3 out = flat.normal() - flat.normal().dot(column.axis) * column.axis;
  if (std::abs(flat.normal().dot(column.axis)) > kSideUpright) return {};
  const Vec3 normal = out.normalized(), across = column.axis.cross(normal);
  Square square{std::atan2(normal.dot(around.b), normal.dot(around.a)), 0, 0, 0, 0};
  square.turn_rad -= kQuarter * std::floor(square.turn_rad / kQuarter);
  double left = 0, right = 0;
  square.low_m = square.high_m = column.along(side.outer[0]);
  for (const Vec3& point : side.outer) {
    square.half_m += normal.dot(point - column.foot) / static_cast<double>(side.outer.size());
    left = std::min(left, across.dot(point - column.foot));
    right = std::max(right, across.dot(point - column.foot));
    square.low_m = std::min(square.low_m, column.along(point));
    square.high_m = std::max(square.high_m, column.along(point));
  }
  const double reach = std::max(right, -left);
  if (reach < kReachesCorner * square.half_m || reach > square.half_m + kPastCorner_m) return {};
  square.area_m2 = (right - left) * (square.high_m - square.low_m);
  return square;
}

double turn_between(double a, double b) {
  const double apart = std::abs(a - b);
  return std::min(apart, kQuarter - apart);
}

bool is_same_square(const Square& a, const Square& b) {
  return turn_between(a.turn_rad, b.turn_rad) < kSameTurn_rad &&
         std::abs(a.half_m - b.half_m) < kSameWidth_m && a.low_m <= b.high_m && b.low_m <= a.high_m;
}

// The larger side's turn and width.
void join(Square& square, const Square& other) {
  const double low_m = std::min(square.low_m, other.low_m), high_m = std::max(square.high_m, other.high_m);
  if (other.area_m2 > square.area_m2) square = other;
  square.low_m = low_m;
  square.high_m = high_m;
}

SpacePolygon side_of(const Cylinder& column, const Around& around, const Square& square, int quarter) {
  const Vec3 out = around.towards(square.turn_rad + quarter * kQuarter), across = column.axis.cross(out);
  const auto corner = [&](double sign, double along_m) -> Vec3 {
    return column.foot + along_m * column.axis + square.half_m * (out + sign * across);
  };
  return {{corner(-1, square.low_m), corner(1, square.low_m), corner(1, square.high_m),
           corner(-1, square.high_m)},
          {}};
}

// At one height about the shaft, its front side up or down.
SpacePolygon level_of(const Cylinder& column, const Around& around, const Square& square, double along_m,
                      bool up) {
  const Vec3 middle = column.foot + along_m * column.axis;
  const double shaft_m = column.radius_at(std::clamp(along_m, 0.0, column.length_m));
  SpacePolygon level;
  for (int k = 0; k < 4; ++k)
    level.outer.push_back(middle + std::numbers::sqrt2 * square.half_m *
                                       around.towards(square.turn_rad + (k + 0.5) * kQuarter));
  level.holes.emplace_back();
  for (int k = 0; k < kShaftCorners; ++k)
    level.holes[0].push_back(middle + shaft_m * around.towards(-k * 4 * kQuarter / kShaftCorners));
  if (up) return level;
  std::reverse(level.outer.begin(), level.outer.end());
  std::reverse(level.holes[0].begin(), level.holes[0].end());
  return level;
}

}  // namespace

std::vector<SpacePolygon> column_squares(const Cylinder& column, ColumnEndKind end,
                                         const std::vector<SpacePolygon>& sides) {
  const Around around(column);
  std::vector<Square> squares;
  for (const SpacePolygon& side : sides) {
    const auto square = square_of(column, around, side);
    if (!square) continue;
    const auto same = std::find_if(squares.begin(), squares.end(),
                                   [&](const Square& other) { return is_same_square(other, *square); });
    if (same == squares.end())
      squares.push_back(*square);
    else
      join(*same, *square);
  }
  std::vector<SpacePolygon> found;
  for (const Square& square : squares) {
    for (int quarter = 0; quarter < 4; ++quarter) found.push_back(side_of(column, around, square, quarter));
    const bool up = end == ColumnEndKind::kBase;
    if (square.half_m > column.radius_m)
      found.push_back(level_of(column, around, square, up ? square.high_m : square.low_m, up));
  }
  return found;
}

}  // namespace hybrid::stages
