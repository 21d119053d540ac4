#include "stages/rendering/column_squares.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace hybrid::stages {
namespace {

constexpr double kSideUpright = 0.1;    // of a side's normal, along the axis
constexpr double kReachesCorner = 0.8;  // of half the width: the sides of an octagon do not
constexpr double kPastCorner_m = 0.03;
constexpr double kSameWidth_m = 0.06;
constexpr double kSameTurn_rad = 0.07;
constexpr double kSideLevel = 0.98;     // of a level's normal, along the axis
constexpr double kSameHeight_m = 0.04;  // a side's border and the level it ends at
constexpr double kHalfWide = 0.5;       // of a side's width: above and below it is spurs of its contour
constexpr int kHeights = 64;            // at which its width is taken
constexpr int kShaftCorners = 24;
constexpr double kQuarter = std::numbers::pi / 2;

// Square about an axis.
struct Square {
  struct Side {
    double apart_m = 0, area_m2 = 0;  // from the axis; of what was seen, 0: nothing
  };
  double turn_rad;              // of the first side's outward normal, from 0 to a quarter or hardly beyond
  std::array<Side, 4> sides{};  // each a quarter of a turn on from the one before
  double low_m, high_m;         // along the axis
};

// The axis' two perpendiculars.
struct Around {
  Vec3 a, b;
  explicit Around(const Cylinder& column) : a(column.axis.unitOrthogonal()), b(column.axis.cross(a)) {}
  Vec3 towards(double turn_rad) const { return std::cos(turn_rad) * a + std::sin(turn_rad) * b; }
};

// Where a side is at least half as wide as where it is widest, from and to, along the axis.
std::pair<double, double> ends_of(const Cylinder& column, const SpacePolygon& side) {
  const FlatPolygon flat(side, column.axis);
  std::array<double, kHeights> width{};
  const auto height = [&](double k) {
    return flat.low().y() + k / kHeights * (flat.high().y() - flat.low().y());
  };
  for (int k = 0; k < kHeights; ++k)
    for (const auto& [from, to] : flat.spans(height(k + 0.5)))
      width[static_cast<std::size_t>(k)] += to - from;
  const double least = kHalfWide * *std::max_element(width.begin(), width.end());
  const auto wide = [&](double one) { return one >= least; };
  const auto first = std::find_if(width.begin(), width.end(), wide) - width.begin();
  const auto last = width.rend() - std::find_if(width.rbegin(), width.rend(), wide);
  const auto along = [&](std::ptrdiff_t k) {
    return column.along(flat.lifted({0, height(static_cast<double>(k))}));
  };
  return {along(first), along(last)};
}

std::optional<Square> square_of(const Cylinder& column, const Around& around, const SpacePolygon& side) {
  const FlatPolygon flat(side);
  const Vec3 out = flat.normal() - flat.normal().dot(column.axis) * column.axis;
  if (std::abs(flat.normal().dot(column.axis)) > kSideUpright) return {};
  const Vec3 normal = out.normalized(), across = column.axis.cross(normal);
  const double turn_rad = std::atan2(normal.dot(around.b), normal.dot(around.a));
  const double quarters = std::floor(turn_rad / kQuarter);
  Square square;
  square.turn_rad = turn_rad - quarters * kQuarter;
  double apart = 0, left = 0, right = 0;
  std::tie(square.low_m, square.high_m) = ends_of(column, side);
  for (const Vec3& point : side.outer) {
    apart += normal.dot(point - column.foot) / static_cast<double>(side.outer.size());
    left = std::min(left, across.dot(point - column.foot));
    right = std::max(right, across.dot(point - column.foot));
  }
  const double reach = std::max(right, -left);
  if (reach < kReachesCorner * apart || reach > apart + kPastCorner_m) return {};
  square.sides[(static_cast<std::size_t>(quarters + 4)) % 4] = {
      apart, (right - left) * (square.high_m - square.low_m)};
  return square;
}

const Square::Side& largest(const Square& square) {
  return *std::max_element(
      square.sides.begin(), square.sides.end(),
      [](const Square::Side& a, const Square::Side& b) { return a.area_m2 < b.area_m2; });
}

bool is_same_square(const Square& a, const Square& b) {
  const double turn = std::abs(a.turn_rad - b.turn_rad);
  return std::min(turn, kQuarter - turn) < kSameTurn_rad &&
         std::abs(largest(a).apart_m - largest(b).apart_m) < kSameWidth_m && a.low_m <= b.high_m &&
         b.low_m <= a.high_m;
}

// Of two that say how far a side is from the axis the larger one counts.
void join(Square& square, Square other) {
  if (const double turn = other.turn_rad - square.turn_rad; std::abs(turn) > 0.5 * kQuarter) {
    // Its first side is this one's second, or this one's last.
    other.turn_rad -= std::copysign(kQuarter, turn);
    std::rotate(other.sides.begin(), turn > 0 ? other.sides.end() - 1 : other.sides.begin() + 1,
                other.sides.end());
  }
  if (largest(other).area_m2 > largest(square).area_m2) square.turn_rad = other.turn_rad;
  for (std::size_t k = 0; k < 4; ++k)
    if (other.sides[k].area_m2 > square.sides[k].area_m2) square.sides[k] = other.sides[k];
  square.low_m = std::min(square.low_m, other.low_m);
  square.high_m = std::max(square.high_m, other.high_m);
}

// A side's border is no better known than its samples lie close: where a level was seen there, the side ends
// at that.
void end_at_levels(Square& square, const Cylinder& column, const std::vector<SpacePolygon>& seen) {
  const double low_m = square.low_m, high_m = square.high_m;
  double to_low_m = kSameHeight_m, to_high_m = kSameHeight_m;
  for (const SpacePolygon& polygon : seen) {
    const FlatPolygon flat(polygon);
    const double up = flat.normal().dot(column.axis);
    if (std::abs(up) < kSideLevel) continue;
    const double along_m = column.along(flat.lifted(0.5 * (flat.low() + flat.high())));
    double& border_m = up < 0 ? square.low_m : square.high_m;
    double& nearest_m = up < 0 ? to_low_m : to_high_m;
    const double apart_m = std::abs(along_m - (up < 0 ? low_m : high_m));
    if (apart_m >= nearest_m) continue;
    nearest_m = apart_m;
    border_m = along_m;
  }
}

// Of each side from the axis, which may be a little off the square's middle: what was not seen is as far from
// the opposite side as the others are from each other.
std::array<double, 4> apart_m(const Square& square) {
  const auto seen = [&](std::size_t k) { return square.sides[k % 4].area_m2 > 0; };
  double sum = 0, count = 0, pairs = 0, pair_count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (seen(k)) sum += square.sides[k].apart_m, ++count;
    if (k < 2 && seen(k) && seen(k + 2))
      pairs += square.sides[k].apart_m + square.sides[k + 2].apart_m, ++pair_count;
  }
  const double width = pair_count > 0 ? pairs / pair_count : 2 * sum / count;
  std::array<double, 4> apart;
  for (std::size_t k = 0; k < 4; ++k)
    apart[k] = seen(k)       ? square.sides[k].apart_m
               : seen(k + 2) ? width - square.sides[(k + 2) % 4].apart_m
                             : 0.5 * width;
  return apart;
}

SpacePolygon side_of(const Cylinder& column, const Around& around, const Square& square, std::size_t side) {
  const auto apart = apart_m(square);
  const Vec3 out = around.towards(square.turn_rad + static_cast<double>(side) * kQuarter),
             across = column.axis.cross(out);
  const auto corner = [&](double across_m, double along_m) -> Vec3 {
    return column.foot + along_m * column.axis + apart[side] * out + across_m * across;
  };
  const double left = -apart[(side + 3) % 4], right = apart[(side + 1) % 4];
  return {{corner(left, square.low_m), corner(right, square.low_m), corner(right, square.high_m),
           corner(left, square.high_m)},
          {}};
}

// At one height about the shaft, its front side up or down.
SpacePolygon level_of(const Cylinder& column, const Around& around, const Square& square, double along_m,
                      bool up) {
  const auto apart = apart_m(square);
  const Vec3 middle = column.foot + along_m * column.axis;
  const double shaft_m = column.radius_at(std::clamp(along_m, 0.0, column.length_m));
  SpacePolygon level;
  for (std::size_t k = 0; k < 4; ++k) {
    const double turn = square.turn_rad + static_cast<double>(k) * kQuarter;
    level.outer.push_back(middle + apart[k] * around.towards(turn) +
                          apart[(k + 1) % 4] * around.towards(turn + kQuarter));
  }
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
                                         const std::vector<SpacePolygon>& seen) {
  const Around around(column);
  std::vector<Square> squares;
  for (const SpacePolygon& side : seen) {
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
  for (Square& square : squares) {
    end_at_levels(square, column, seen);
    for (std::size_t side = 0; side < 4; ++side) found.push_back(side_of(column, around, square, side));
    const bool up = end == ColumnEndKind::kBase;
    const auto apart = apart_m(square);
    if (*std::min_element(apart.begin(), apart.end()) > column.radius_m)
      found.push_back(level_of(column, around, square, up ? square.high_m : square.low_m, up));
  }
  return found;
}

}  // namespace hybrid::stages
