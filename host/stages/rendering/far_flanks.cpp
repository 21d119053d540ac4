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
constexpr double kTouch_m = 0.04;  // between the borders of a front and its flank
constexpr double kBefore_m = 0.03;
constexpr double kRow_m = 0.02, kMostRows = 512;
constexpr double kMostBeyond_m = 0.16;  // a border, what is seen to be empty
constexpr double kWithin_m = 0.03;      // of a border, where is asked what is behind it
constexpr double kBehind_m = 0.04;      // from where on
constexpr double kLeast_m = 0.06;       // of depth, width and height
constexpr double kStraight_m = 0.04, kSameDepth_m = 0.1;
constexpr double kMostEmptyBehind = 0.1, kLeastUnknownBehind = 0.5;  // of the places behind a border

constexpr double kHidden = -1;
constexpr double kLeastSeen = 0.5;  // of a border

// Where a polygon's border opposite to a seen flank is, how far beyond it the first empty place is seen, if
// nothing hides that, and how deep the flank goes.
struct Row {
  double x_m, y_m, beyond_m, depth_m;
};

class Front {
 public:
  // `beside`: the faces that may be where the flank would be.
  Front(const ScanSight& sight, const SpacePolygon& front, const Vec3& normal, const SpacePolygon& flank,
        const Vec3& flank_normal, const std::vector<const FlatPolygon*>& beside)
      : sight_(sight),
        beside_(beside),
        normal_(normal),
        up_(normal.cross(flank_normal).normalized()),
        front_(front, up_),
        flank_(flank, up_) {
    flank_up_m_ = up_.dot(flank.outer[0] - front.outer[0]);
    surface_m_ = flank_.flat(front.outer[0]).x();
  }

  std::vector<std::array<Vec3, 4>> quadrilaterals() const {
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
  std::optional<Row> row_at(double y) const {
    const auto across = front_.spans(y);
    const auto back = flank_.spans(y - flank_up_m_);
    if (across.empty() || back.empty()) return {};
    Row row{across.front().first, y, kRow_m, back.back().second - surface_m_};
    if (across.back().second - row.x_m < kLeast_m || row.depth_m < kLeast_m) return {};
    for (; row.beyond_m <= kMostBeyond_m; row.beyond_m += kRow_m)
      if (sight_.is_empty(at(row.x_m - row.beyond_m, y, 0))) return row;
    row.beyond_m = kHidden;
    if (sight_.is_known(at(row.x_m - kMostBeyond_m, y, 0))) return {};
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

  void append(const std::vector<Row>& run, double step, std::vector<std::array<Vec3, 4>>& found) const {
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

  bool is_hidden_behind(const std::vector<Row>& run) const {
    std::size_t all = 0, empty = 0, unknown = 0;
    for (const Row& row : run)
      for (double depth = kBehind_m; depth < row.depth_m; depth += kRow_m) {
        const Vec3 place = at(row.x_m + kWithin_m, row.y_m, depth);
        ++all;
        empty += sight_.is_empty(place);
        unknown += !sight_.is_known(place) && !is_there(at(row.x_m, row.y_m, depth));
      }
    const auto whole = static_cast<double>(all);
    return static_cast<double>(empty) <= kMostEmptyBehind * whole &&
           static_cast<double>(unknown) >= kLeastUnknownBehind * whole;
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

  const ScanSight& sight_;
  const std::vector<const FlatPolygon*>& beside_;
  Vec3 normal_, up_;
  FlatPolygon front_, flank_;  // second coordinates along the edge they share
  double flank_up_m_ = 0;      // of the flank's origin over the front's, along that edge
  double surface_m_ = 0;       // of the front, along the flank
};

struct Box {
  Vec3 low, high;
  explicit Box(const SpacePolygon& polygon) : low(polygon.outer[0]), high(low) {
    for (const Vec3& point : polygon.outer) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  bool is_near(const Box& other) const {
    return (low.array() <= other.high.array() + kTouch_m).all() &&
           (other.low.array() <= high.array() + kTouch_m).all();
  }
};

// Whether all of a polygon is behind a plane, and some of it near.
bool begins_at(const SpacePolygon& polygon, const Vec3& point, const Vec3& normal) {
  double highest = -kTouch_m - 1;
  for (const Vec3& corner : polygon.outer) highest = std::max(highest, normal.dot(corner - point));
  return highest <= kBefore_m && highest >= -kTouch_m;
}

}  // namespace

std::vector<FarFlank> far_flanks(const ScanSight& sight, const PolygonModel& contours, std::size_t seen) {
  std::vector<SpacePolygon> polygons;
  std::vector<FlatPolygon> flat;
  std::vector<Box> boxes;
  for (const Face& face : contours.faces) {
    polygons.push_back(polygon_of(contours, face));
    flat.emplace_back(polygons.back());
    boxes.emplace_back(polygons.back());
  }
  std::vector<std::vector<FarFlank>> of_face(seen);
  parallel_for(seen, [&](std::size_t front) {
    const Vec3& normal = flat[front].normal();
    std::vector<std::size_t> near;
    for (std::size_t face = 0; face < polygons.size(); ++face)
      if (boxes[front].is_near(boxes[face]) && std::abs(normal.dot(flat[face].normal())) <= kSquare)
        near.push_back(face);
    for (const std::size_t flank : near) {
      if (flank >= seen || !begins_at(polygons[front], polygons[flank].outer[0], flat[flank].normal()) ||
          !begins_at(polygons[flank], polygons[front].outer[0], normal))
        continue;
      std::vector<const FlatPolygon*> beside;
      for (const std::size_t face : near)
        if (flat[face].normal().dot(flat[flank].normal()) < -kOpposite) beside.push_back(&flat[face]);
      const Front both(sight, polygons[front], normal, polygons[flank], flat[flank].normal(), beside);
      for (const auto& corners : both.quadrilaterals()) of_face[front].push_back({front, corners});
    }
  });
  std::vector<FarFlank> all;
  for (const auto& some : of_face) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace hybrid::stages
