#include "stages/rendering/far_flanks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.hpp"
#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSquare = 0.1;    // cosine between a front's normal and its flank's
constexpr double kOpposite = 0.9;  // between its two flanks' normals, negative
constexpr double kTouch_m = 0.08;  // between the borders of a front and its flank
constexpr double kBefore_m = 0.03;
constexpr double kRow_m = 0.02, kMostRows = 512;
constexpr double kMostBeyond_m = 0.16;  // a border, what is seen to be empty
constexpr double kWithin_m = 0.03;      // of a border, where is asked what is behind it
constexpr double kBehind_m = 0.04;      // from where on
constexpr double kLeast_m = 0.06;       // of depth, width and height
constexpr double kDeepest = 2;          // times the front's width: a bench's back is no flank of its end
constexpr double kStraight_m = 0.04, kSameDepth_m = 0.1;
constexpr double kMostEmptyBehind = 0.1, kLeastUnknownBehind = 0.5;  // of the places behind a border

constexpr double kHidden = -1;
constexpr double kLeastSeen = 0.5;  // of a border

// Where a polygon's border opposite to a seen flank is, how far beyond it the first empty place is seen, if
// nothing hides that, and how deep the flank goes.
struct Row {
  double x_m, y_m, beyond_m, depth_m;
};

// A polygon and what goes on with it, in the polygon's coordinates.
class Surface {
 public:
  Surface(const SpacePolygon& polygon, const std::vector<const SpacePolygon*>& more, const Vec3& second)
      : own_(polygon, second), low_(own_.low()), high_(own_.high()) {
    parts_.push_back({own_, Vec2::Zero()});
    for (const SpacePolygon* part : more) {
      const FlatPolygon flat(*part, second);
      const Vec2 shift = own_.flat(part->outer[0]) - flat.flat(part->outer[0]);
      low_ = low_.cwiseMin(flat.low() + shift);
      high_ = high_.cwiseMax(flat.high() + shift);
      parts_.push_back({flat, shift});
    }
  }

  Vec2 flat(const Vec3& point) const { return own_.flat(point); }
  Vec3 lifted(const Vec2& at) const { return own_.lifted(at); }
  const Vec2& low() const { return low_; }
  const Vec2& high() const { return high_; }

  // Where a line of constant second coordinate enters it first and leaves it last.
  std::optional<std::pair<double, double>> extent(double y) const {
    std::optional<std::pair<double, double>> all;
    for (const auto& [polygon, shift] : parts_)
      for (const auto& [from, to] : polygon.spans(y - shift.y())) {
        if (!all) all = {from + shift.x(), to + shift.x()};
        all = {std::min(all->first, from + shift.x()), std::max(all->second, to + shift.x())};
      }
    return all;
  }

 private:
  struct Part {
    FlatPolygon polygon;
    Vec2 shift;  // to the first one's coordinates
  };
  FlatPolygon own_;
  std::vector<Part> parts_;
  Vec2 low_, high_;
};

class Front {
 public:
  // `front`, `flank`: with second coordinates along the edge they share. `beside`: the faces that may be
  // where the flank would be.
  Front(const ScanSight& sight, const Vec3& normal, const Vec3& up, Surface front, Surface flank,
        const std::vector<const FlatPolygon*>& beside)
      : walk_(sight),
        beside_(beside),
        normal_(normal),
        front_(std::move(front)),
        flank_(std::move(flank)),
        flank_up_m_(up.dot(flank_.lifted(Vec2::Zero()) - front_.lifted(Vec2::Zero()))),
        surface_m_(flank_.flat(front_.lifted(Vec2::Zero())).x()) {}

  std::vector<std::array<Vec3, 4>> quadrilaterals() {
    const double low = std::max(front_.low().y(), flank_.low().y() + flank_up_m_),
                 high = std::min(front_.high().y(), flank_.high().y() + flank_up_m_);
    std::vector<std::array<Vec3, 4>> found;
    if (!(high > low)) return found;
    const double step = std::max(kRow_m, (high - low) / kMostRows);
    std::vector<Row> run;
    for (double y = low + 0.5 * step; y < high; y += step) {
      const auto row = row_at(y);
      if (!run.empty() && (!row || !goes_on(run, *row))) {
        append(run, step, found);
        run.clear();
      }
      if (row) run.push_back(*row);
    }
    if (!run.empty()) append(run, step, found);
    return found;
  }

 private:
  std::optional<Row> row_at(double y) {
    const auto across = front_.extent(y), back = flank_.extent(y - flank_up_m_);
    if (!across || !back) return {};
    Row row{across->first, y, kRow_m, back->second - surface_m_};
    const double width = across->second - row.x_m;
    if (width < kLeast_m || row.depth_m < kLeast_m || row.depth_m > kDeepest * width) return {};
    for (; row.beyond_m <= kMostBeyond_m; row.beyond_m += kRow_m)
      if (walk_.known(at(row.x_m - row.beyond_m, y, 0)) == ScanSight::Known::empty) return row;
    row.beyond_m = kHidden;
    if (walk_.known(at(row.x_m - kMostBeyond_m, y, 0)) != ScanSight::Known::no) return {};
    return row;
  }

  // On a line with those before, as deep.
  static bool goes_on(const std::vector<Row>& run, const Row& next) {
    const Row& first = run.front();
    if (std::abs(next.depth_m - first.depth_m) > kSameDepth_m) return false;
    return std::all_of(run.begin(), run.end(), [&](const Row& row) {
      const double share = (row.y_m - first.y_m) / (next.y_m - first.y_m);
      return std::abs(row.x_m - first.x_m - share * (next.x_m - first.x_m)) <= kStraight_m;
    });
  }

  Vec3 at(double x, double y, double depth) const { return front_.lifted({x, y}) - depth * normal_; }

  void append(const std::vector<Row>& run, double step, std::vector<std::array<Vec3, 4>>& found) {
    const double low = run.front().y_m - 0.5 * step, high = run.back().y_m + 0.5 * step;
    if (high - low < kLeast_m || !is_hidden_behind(run)) return;
    std::vector<Row> seen;
    for (const Row& row : run)
      if (row.beyond_m != kHidden) seen.push_back(row);
    if (static_cast<double>(seen.size()) < kLeastSeen * static_cast<double>(run.size())) return;
    const double depth = middle(run, &Row::depth_m), beyond = 0.5 * middle(seen, &Row::beyond_m);
    const double from = run.front().x_m - beyond, to = run.back().x_m - beyond;
    found.push_back({at(from, low, depth), at(from, low, 0), at(to, high, 0), at(to, high, depth)});
  }

  bool is_hidden_behind(const std::vector<Row>& run) {
    std::size_t all = 0, asked = 0, empty = 0, unknown = 0;
    for (const Row& row : run)
      for (double depth = kBehind_m; depth < row.depth_m; depth += kRow_m) ++all;
    const auto whole = static_cast<double>(all);
    for (const Row& row : run)
      for (double depth = kBehind_m; depth < row.depth_m; depth += kRow_m) {
        const auto known = walk_.known(at(row.x_m + kWithin_m, row.y_m, depth));
        ++asked;
        empty += known == ScanSight::Known::empty;
        unknown += known == ScanSight::Known::no && !is_there(at(row.x_m, row.y_m, depth));
        if (static_cast<double>(empty) > kMostEmptyBehind * whole ||
            static_cast<double>(unknown + all - asked) < kLeastUnknownBehind * whole)
          return false;
      }
    return true;
  }

  bool is_there(const Vec3& place) const {
    return std::any_of(beside_.begin(), beside_.end(),
                       [&](const FlatPolygon* face) { return face->covers(place, kMostBeyond_m); });
  }

  static double middle(const std::vector<Row>& run, double Row::*value) {
    std::vector<double> values;
    for (const Row& row : run) values.push_back(row.*value);
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    return *half;
  }

  SightWalk walk_;
  const std::vector<const FlatPolygon*>& beside_;
  Vec3 normal_;
  Surface front_, flank_;
  double flank_up_m_;  // of the flank's origin over the front's, along the edge they share
  double surface_m_;   // of the front, along the flank
};

// Whether all of a polygon is behind a plane, and some of it near.
bool begins_at(const SpacePolygon& polygon, const Vec3& point, const Vec3& normal) {
  double highest = -kTouch_m - 1;
  for (const Vec3& corner : polygon.outer) highest = std::max(highest, normal.dot(corner - point));
  return highest <= kBefore_m && highest >= -kTouch_m;
}

}  // namespace

std::vector<FarFlank> far_flanks(const ScanSight& sight, const PolygonModel& contours,
                                 const std::vector<std::size_t>& part_of) {
  const std::size_t count = contours.faces.size();
  std::vector<SpacePolygon> polygons;
  std::vector<FlatPolygon> flat;
  std::vector<PolygonBox> boxes;
  for (const Face& face : contours.faces) {
    polygons.push_back(polygon_of(contours, face));
    flat.emplace_back(polygons.back());
    boxes.emplace_back(polygons.back());
  }
  std::vector<std::vector<const SpacePolygon*>> more(count);
  for (std::size_t face = 0; face < count; ++face)
    if (part_of[face] != face && part_of[face] != kPartOfNone) more[part_of[face]].push_back(&polygons[face]);
  std::vector<std::vector<FarFlank>> of_face(count);
  parallel_for(count, [&](std::size_t front) {
    if (part_of[front] != front) return;
    const Vec3& normal = flat[front].normal();
    std::vector<std::size_t> near;
    for (std::size_t face = 0; face < count; ++face)
      if (boxes[front].is_near(boxes[face], kTouch_m) && std::abs(normal.dot(flat[face].normal())) <= kSquare)
        near.push_back(face);
    for (const std::size_t flank : near) {
      const Vec3& beside_normal = flat[flank].normal();
      if (part_of[flank] != flank || !begins_at(polygons[front], polygons[flank].outer[0], beside_normal) ||
          !begins_at(polygons[flank], polygons[front].outer[0], normal))
        continue;
      std::vector<const FlatPolygon*> beside;
      for (const std::size_t face : near)
        if (flat[face].normal().dot(beside_normal) < -kOpposite) beside.push_back(&flat[face]);
      const Vec3 up = normal.cross(beside_normal).normalized();
      Front both(sight, normal, up, Surface(polygons[front], more[front], up),
                 Surface(polygons[flank], more[flank], up), beside);
      for (const auto& corners : both.quadrilaterals()) of_face[front].push_back({front, corners});
    }
  });
  std::vector<FarFlank> all;
  for (const auto& some : of_face) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace hybrid::stages
