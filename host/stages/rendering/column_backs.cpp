#include "stages/rendering/column_backs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSide_rad = 2 * std::numbers::pi / kColumnSides;

// Of bases and heads: thin slices whose samples are equally far from the axis.
constexpr double kThin_m = 0.02, kProfileReach = 2;  // radii from an end, along the axis
constexpr double kNearest = 0.6, kFarthest = 2.2;    // radii from the axis
constexpr std::size_t kFewestInSlice = 8;            // samples of a slice
constexpr double kSpread = 0.16;                     // of the radius, within which most of them are
constexpr double kMost = 0.6;
constexpr int kMostMissing = 5;  // slices one after the other that are not round or hidden
constexpr double kSimplify_m = 0.01;
constexpr double kLeastMore_m = 0.04;  // that another column's outline must tell
constexpr double kAlike = 0.1;         // of the radius, between two outlines

// A column's outline at a height: along its axis, from it.
struct Height {
  double along_m, radius_m;
};

// Appends what stays of an outline after its place `first`, up to `last` (Douglas and Peucker).
void simplify(const std::vector<Height>& outline, std::size_t first, std::size_t last,
              std::vector<Height>& kept) {
  if (last == first) return;
  const Height &from = outline[first], &to = outline[last];
  std::size_t farthest = first;
  double most = kSimplify_m;
  for (std::size_t k = first + 1; k < last; ++k) {
    const double share = (outline[k].along_m - from.along_m) / (to.along_m - from.along_m);
    const double off = std::abs(outline[k].radius_m - from.radius_m - share * (to.radius_m - from.radius_m));
    if (off <= most) continue;
    most = off;
    farthest = k;
  }
  if (farthest == first) {
    kept.push_back(to);
    return;
  }
  simplify(outline, first, farthest, kept);
  simplify(outline, farthest, last, kept);
}

// What most samples of a slice have, but for what stands beside the column; nothing where it is not round.
std::optional<double> common_radius(std::vector<double>& radii, double spread) {
  if (radii.size() < kFewestInSlice) return std::nullopt;
  std::sort(radii.begin(), radii.end());
  std::size_t first = 0, count = 0, end = 0;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    while (end < radii.size() && radii[end] <= radii[k] + spread) ++end;
    if (end - k <= count) continue;
    count = end - k;
    first = k;
  }
  if (static_cast<double>(count) < kMost * static_cast<double>(radii.size())) return std::nullopt;
  return radii[first + count / 2];
}

// Of the base (-1) or the head (1), from the shaft's end outwards, as far as it is round; at least the end.
std::vector<Height> profile(const ScanSight& sight, const Cylinder& column, int end) {
  const double from = end < 0 ? 0 : column.length_m, reach = kProfileReach * column.radius_m;
  std::vector<std::vector<double>> radii(static_cast<std::size_t>(reach / kThin_m));
  const Vec3 middle = column.foot + (from + 0.5 * end * reach) * column.axis;
  for (const Vec3& point : sight.samples_near(middle, std::hypot(0.5 * reach, kFarthest * column.radius_m))) {
    const double beyond = end * (column.along(point) - from), radius = column.outwards(point).norm();
    if (!(beyond > 0) || radius < kNearest * column.radius_m || radius > kFarthest * column.radius_m)
      continue;
    const auto slice = static_cast<std::size_t>(beyond / kThin_m);
    if (slice < radii.size()) radii[slice].push_back(radius);
  }
  std::vector<Height> outline = {{from, column.radius_at(from)}};
  int missing = 0;
  for (std::size_t slice = 0; slice < radii.size(); ++slice) {
    const auto radius = common_radius(radii[slice], kSpread * column.radius_m);
    missing = radius ? 0 : missing + 1;
    if (missing > kMostMissing) break;
    if (!radius) continue;
    outline.push_back({from + end * (static_cast<double>(slice) + 0.5) * kThin_m, *radius});
  }
  std::vector<Height> heights = {outline[0]};
  simplify(outline, 0, outline.size() - 1, heights);
  return heights;
}

// The outlines of a column's base and head, each from the shaft's end outwards.
struct Ends {
  std::vector<Height> base, head;
};

std::optional<double> radius_at(const std::vector<Height>& outline, double along_m) {
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const Height &a = outline[k], &b = outline[k + 1];
    if ((along_m - a.along_m) * (along_m - b.along_m) <= 0 && a.along_m != b.along_m)
      return a.radius_m + (b.radius_m - a.radius_m) * (along_m - a.along_m) / (b.along_m - a.along_m);
  }
  return std::nullopt;
}

// Another column's outline along this one's axis, at the same height in the world, with its shaft up to
// where this one's is.
std::vector<Height> carried_over(const Cylinder& column, const Cylinder& other,
                                 const std::vector<Height>& outline, int end) {
  const double shift_m = column.along(other.foot);
  std::vector<Height> moved;
  if (const double from = end < 0 ? 0 : column.length_m; end * (outline[0].along_m + shift_m - from) > 0)
    moved.push_back({from, other.radius_at(std::clamp(from - shift_m, 0.0, other.length_m))});
  for (const Height& height : outline) moved.push_back({height.along_m + shift_m, height.radius_m});
  return moved;
}

// Columns of one design have the same bases and heads at the same height: where what stands before a column
// hides its own from every scan, the outline of the one like it that was seen farthest goes on from its own.
void share_ends(const std::vector<SightColumn>& columns, std::vector<Ends>& all) {
  const auto seen = all;
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const int end : {-1, 1}) {
      const auto of = [end](auto& ends) -> auto& {
        return end < 0 ? ends.base : ends.head;
      };
      const Cylinder& column = columns[k].cylinder;
      auto& own = of(all[k]);
      const Height last = own.back();
      std::vector<Height> best;
      for (std::size_t j = 0; j < columns.size(); ++j) {
        if (j == k || !is_alike(column, columns[j].cylinder)) continue;
        auto outline = carried_over(column, columns[j].cylinder, of(seen[j]), end);
        const double farther = end * (outline.back().along_m - (best.empty() ? last : best.back()).along_m);
        if (farther < (best.empty() ? kLeastMore_m : 0.001)) continue;
        const auto here = radius_at(outline, last.along_m);
        if (here && std::abs(*here - last.radius_m) <= kAlike * column.radius_m) best = std::move(outline);
      }
      for (const Height& height : best)
        if (end * (height.along_m - last.along_m) > 0) own.push_back(height);
    }
}

Vec3 place_on(const Cylinder& cylinder, const Height& height, double turn_rad) {
  const Vec3 a = cylinder.axis.unitOrthogonal(), b = cylinder.axis.cross(a);
  return cylinder.foot + height.along_m * cylinder.axis +
         height.radius_m * (std::cos(turn_rad) * a + std::sin(turn_rad) * b);
}

// What no scan knows between the first height and the last, which lie on a line; from below upwards.
void append_backs(const ScanSight& sight, const SightColumn& column, const std::vector<Height>& heights,
                  std::vector<ColumnBack>& backs) {
  const auto at = [&](const Height& height, double side) {
    return place_on(column.cylinder, height, kSide_rad * side);
  };
  const auto middle = [&](std::size_t k) {
    const Height &low = heights[k], &high = heights[k + 1];
    return Height{0.5 * (low.along_m + high.along_m), 0.5 * (low.radius_m + high.radius_m)};
  };
  for (int side = 0; side < kColumnSides; ++side) {
    std::size_t first = 0;
    for (std::size_t k = 0; k < heights.size(); ++k) {
      if (k + 1 < heights.size() && sight.known(at(middle(k), side + 0.5)) == ScanSight::Known::no) continue;
      const Height &low = heights[first], &high = heights[k];
      if (k > first)
        backs.push_back({column.scan,
                         column.cylinder.id,
                         {at(low, side), at(low, side + 1), at(high, side + 1), at(high, side)}});
      first = k + 1;
    }
  }
}

std::vector<ColumnBack> backs_of(const ScanSight& sight, const SightColumn& column, const Ends& ends) {
  const Cylinder& cylinder = column.cylinder;
  const int slices = std::max(1, static_cast<int>(std::lround(cylinder.length_m / kColumnSlice_m)));
  std::vector<Height> shaft;
  for (int k = 0; k <= slices; ++k) {
    const double along = cylinder.length_m * k / slices;
    shaft.push_back({along, cylinder.radius_at(along)});
  }
  std::vector<ColumnBack> backs;
  append_backs(sight, column, shaft, backs);
  for (const int end : {-1, 1}) {
    const auto& heights = end < 0 ? ends.base : ends.head;
    for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
      std::vector<Height> stretch = {heights[k], heights[k + 1]};
      if (end < 0) std::swap(stretch[0], stretch[1]);
      append_backs(sight, column, stretch, backs);
    }
  }
  return backs;
}

}  // namespace

Vec3 on_cylinder(const Cylinder& cylinder, double along_m, double turn_rad, double off_m) {
  const double radius = cylinder.radius_at(std::clamp(along_m, 0.0, cylinder.length_m)) + off_m;
  return place_on(cylinder, {along_m, radius}, turn_rad);
}

std::vector<ColumnBack> column_backs(const ScanSight& sight) {
  const auto columns = sight.columns();
  std::vector<Ends> ends(columns.size());
  parallel_for(columns.size(), [&](std::size_t k) {
    ends[k] = {profile(sight, columns[k].cylinder, -1), profile(sight, columns[k].cylinder, 1)};
  });
  share_ends(columns, ends);
  std::vector<std::vector<ColumnBack>> of_column(columns.size());
  parallel_for(columns.size(), [&](std::size_t k) { of_column[k] = backs_of(sight, columns[k], ends[k]); });
  std::vector<ColumnBack> backs;
  for (const auto& some : of_column) backs.insert(backs.end(), some.begin(), some.end());
  return backs;
}

}  // namespace hybrid::stages
