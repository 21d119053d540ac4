#include "stages/rendering/shadow_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "core/parallel.hpp"
#include "stages/rendering/cell_outlines.hpp"
#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kCell_m = 0.02;
constexpr int kMostCells = 256;           // across a polygon: of a larger one they are larger
constexpr double kMostSeenThrough = 0.2;  // of a part's border
constexpr double kLeastHidden = 0.5;      // of a part: of the rest no scan says anything
constexpr int kLeastCells = 4;            // of a part
constexpr double kNarrowHole_m = 0.14;    // in which nothing was measured
constexpr double kStairs = 0.75;          // of a cell: what is left of stairs is straight
constexpr double kSquareCorner = 0.1;     // cosine between the normals of polygons that meet at a corner
constexpr double kCorner_m = 0.2;         // between them, and of their borders: samples stop short of edges
constexpr double kOneNormal = 1 - 1e-6, kOnePlane_m = 1e-3;  // of polygons of one plane
constexpr std::array<std::pair<int, int>, 4> kFourBeside = {{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};

// What the scans say of a cell of a polygon's plane.
enum class Cell : std::uint8_t { kUnsure, kSeen, kHidden, kEmpty };

class Shadow {
 public:
  // `foot_m`: how far below the polygon it may go on.
  Shadow(const ScanSight& sight, const FlatPolygon& polygon, double foot_m, std::size_t scan)
      : polygon_(polygon), low_(polygon.low() - Vec2(0, foot_m)) {
    const Vec2 size = polygon.high() - low_;
    step_ = std::max(kCell_m, size.maxCoeff() / kMostCells);
    cols_ = std::max(1, static_cast<int>(std::ceil(size.x() / step_)));
    rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / step_)));
    cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_), Cell::kUnsure);
    for (int row = 0; row < rows_; ++row) look(sight, scan, row);
    doubt_single_beams();
  }

  std::vector<PolygonModel> polygons() const {
    auto filled = between();
    keep_shadows(filled);
    overlap(filled);
    std::vector<PolygonModel> found;
    for (const CellOutline& outline : cell_outlines(filled, cols_)) {
      // Where straight lines instead of stairs will not do, as drawn; where holes touch, without them.
      for (const auto& tried : {straightened(outline), outline, CellOutline{outline.outer, {}}}) {
        PolygonModel model = model_of(on_plane(tried));
        if (!can_be_triangulated(model)) continue;
        found.push_back(std::move(model));
        break;
      }
    }
    return found;
  }

 private:
  std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }
  bool is_in(int row, int col) const { return row >= 0 && col >= 0 && row < rows_ && col < cols_; }

  void look(const ScanSight& sight, std::size_t scan, int row) {
    const double y = low_.y() + (row + 0.5) * step_;
    for (const auto& [from, to] : polygon_.spans(y)) {
      const int first = static_cast<int>(std::ceil((from - low_.x()) / step_ - 0.5));
      const int last = static_cast<int>(std::floor((to - low_.x()) / step_ - 0.5));
      for (int col = std::max(first, 0); col <= std::min(last, cols_ - 1); ++col)
        cells_[at(row, col)] = Cell::kSeen;
    }
    for (int col = 0; col < cols_; ++col) {
      Cell& cell = cells_[at(row, col)];
      if (cell == Cell::kSeen) continue;
      const Vec3 place = polygon_.lifted({low_.x() + (col + 0.5) * step_, y});
      if (sight.is_hidden(place, scan)) cell = Cell::kHidden;
      if (sight.is_empty(place)) cell = Cell::kEmpty;
    }
  }

  // One cell alone that a scan sees past, among such as nothing is known of: dark and glossy things return at
  // the wrong range, if at all.
  void doubt_single_beams() {
    const auto seen = cells_;
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        const auto is_empty = [&](const std::pair<int, int>& side) {
          return is_in(row + side.first, col + side.second) &&
                 seen[at(row + side.first, col + side.second)] == Cell::kEmpty;
        };
        if (seen[at(row, col)] == Cell::kEmpty && std::ranges::none_of(kFourBeside, is_empty))
          cells_[at(row, col)] = Cell::kUnsure;
      }
  }

  // The kind of cell at which a walk through what is not seen ends; at the grid's border kUnsure.
  Cell end_of(int row, int col, int up, int across) const {
    for (; is_in(row, col); row += up, col += across)
      if (const Cell cell = cells_[at(row, col)]; cell == Cell::kSeen || cell == Cell::kEmpty) return cell;
    return Cell::kUnsure;
  }

  std::vector<std::uint8_t> between() const {
    std::vector<std::uint8_t> filled(cells_.size(), 0);
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        const Cell cell = cells_[at(row, col)];
        if (cell == Cell::kSeen || cell == Cell::kEmpty) continue;
        const auto seen = [&](int up, int across) { return end_of(row, col, up, across) == Cell::kSeen; };
        const bool stands = !polygon_.is_level() && end_of(row, col, -1, 0) == Cell::kUnsure;
        filled[at(row, col)] = (seen(0, 1) && seen(0, -1)) || (seen(1, 0) && (stands || seen(-1, 0)));
      }
    return filled;
  }

  // Of the connected parts those that something hides and nothing looks through beside them.
  void keep_shadows(std::vector<std::uint8_t>& filled) const {
    std::vector<std::uint8_t> done(filled.size(), 0);
    std::vector<std::pair<int, int>> part;
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        if (!filled[at(row, col)] || done[at(row, col)]) continue;
        std::size_t seen = 0, empty = 0, hidden = 0;
        part = {{row, col}};
        done[at(row, col)] = 1;
        for (std::size_t k = 0; k < part.size(); ++k) {
          const auto [r, c] = part[k];
          hidden += cells_[at(r, c)] == Cell::kHidden;
          for (const auto& [up, across] : kFourBeside) {
            const int y = r + up, x = c + across;
            if (!is_in(y, x)) continue;
            seen += cells_[at(y, x)] == Cell::kSeen;
            empty += cells_[at(y, x)] == Cell::kEmpty;
            if (!filled[at(y, x)] || done[at(y, x)]) continue;
            done[at(y, x)] = 1;
            part.emplace_back(y, x);
          }
        }
        const auto share = [](std::size_t some, std::size_t all) {
          return static_cast<double>(some) / static_cast<double>(std::max<std::size_t>(all, 1));
        };
        if (part.size() >= kLeastCells && share(hidden, part.size()) >= kLeastHidden &&
            share(empty, empty + seen) <= kMostSeenThrough)
          continue;
        if (empty == 0 && mean_width_m(part) <= kNarrowHole_m) continue;
        for (const auto& [r, c] : part) filled[at(r, c)] = 0;
      }
  }

  // Of a part's cells, its area over its longer side.
  double mean_width_m(const std::vector<std::pair<int, int>>& part) const {
    int low = rows_, high = 0, left = cols_, right = 0;
    for (const auto& [row, col] : part) {
      low = std::min(low, row), high = std::max(high, row + 1);
      left = std::min(left, col), right = std::max(right, col + 1);
    }
    return step_ * static_cast<double>(part.size()) / std::max(high - low, right - left);
  }

  // One cell more onto what is seen, so that no slit stays.
  void overlap(std::vector<std::uint8_t>& filled) const {
    const auto parts = filled;
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        if (cells_[at(row, col)] != Cell::kSeen) continue;
        for (const auto& [up, across] : kFourBeside)
          if (is_in(row + up, col + across) && parts[at(row + up, col + across)]) filled[at(row, col)] = 1;
      }
  }

  static CellOutline straightened(const CellOutline& outline) {
    CellOutline straight{simplified(outline.outer, kStairs), {}};
    for (const Ring2& hole : outline.holes)
      if (Ring2 ring = simplified(hole, kStairs); ring.size() >= 3) straight.holes.push_back(std::move(ring));
    return straight.outer.size() >= 3 ? straight : outline;
  }

  SpacePolygon on_plane(const CellOutline& outline) const {
    const auto ring = [&](const Ring2& cells) {
      std::vector<Vec3> points;
      for (const Vec2& corner : cells) points.push_back(polygon_.lifted(low_ + step_ * corner));
      return points;
    };
    SpacePolygon polygon{ring(outline.outer), {}};
    for (const Ring2& hole : outline.holes) polygon.holes.push_back(ring(hole));
    return polygon;
  }

  const FlatPolygon& polygon_;
  Vec2 low_;
  double step_ = kCell_m;
  int rows_ = 0, cols_ = 0;
  std::vector<Cell> cells_;  // the lowest row first
};

// How far below an upright polygon an upright one goes that it meets at a corner, border at border, in the
// first one's coordinates; 0 where it meets none there.
double goes_down_m(const FlatPolygon& own, const FlatPolygon& other) {
  if (own.is_level() || other.is_level() || std::abs(own.normal().dot(other.normal())) > kSquareCorner)
    return 0;
  for (const double x : {own.low().x(), own.high().x()}) {
    const Vec3 corner = own.lifted(Vec2(x, own.low().y()));
    const Vec2 at = other.flat(corner);
    const double within = std::min(at.x() - other.low().x(), other.high().x() - at.x());
    if (std::abs(within) > kCorner_m || at.y() < other.low().y() || at.y() > other.high().y() + kCorner_m ||
        (other.lifted(at) - corner).norm() > kCorner_m)
      continue;
    const double steep = own.lifted(Vec2(0, 1)).z() - own.lifted(Vec2(0, 0)).z();
    return (corner.z() - other.lifted(Vec2(0, other.low().y())).z()) / steep;
  }
  return 0;
}

// Upright ones.
bool are_in_one_plane(const FlatPolygon& own, const FlatPolygon& other) {
  const Vec3 apart = other.lifted(other.low()) - own.lifted(own.low());
  return !own.is_level() && own.normal().dot(other.normal()) > kOneNormal &&
         std::abs(own.normal().dot(apart)) < kOnePlane_m;
}

}  // namespace

std::vector<ShadowFace> shadow_faces(const ScanSight& sight, const PolygonModel& contours,
                                     const std::vector<std::size_t>& scan_of_face) {
  std::vector<FlatPolygon> polygons;
  std::vector<PolygonBox> boxes;
  for (const Face& face : contours.faces) {
    const SpacePolygon polygon = polygon_of(contours, face);
    polygons.emplace_back(polygon);
    boxes.emplace_back(polygon);
  }
  std::vector<double> own_foot_m(polygons.size(), 0.0);
  parallel_for(polygons.size(), [&](std::size_t face) {
    for (std::size_t other = 0; other < polygons.size(); ++other)
      if (boxes[face].is_near(boxes[other], kCorner_m))
        own_foot_m[face] = std::max(own_foot_m[face], goes_down_m(polygons[face], polygons[other]));
  });
  // Parts of one surface stand on the same ground.
  const auto foot_m = [&](std::size_t face) {
    double most_m = own_foot_m[face];
    for (std::size_t other = 0; other < polygons.size(); ++other)
      if (scan_of_face[other] == scan_of_face[face] && boxes[face].is_near(boxes[other], kCorner_m) &&
          are_in_one_plane(polygons[face], polygons[other])) {
        const Vec3 foot = polygons[other].lifted(polygons[other].low() - Vec2(0, own_foot_m[other]));
        most_m = std::max(most_m, polygons[face].low().y() - polygons[face].flat(foot).y());
      }
    return most_m;
  };
  std::vector<std::vector<ShadowFace>> of_face(contours.faces.size());
  parallel_for(of_face.size(), [&](std::size_t face) {
    for (auto& polygon : Shadow(sight, polygons[face], foot_m(face), scan_of_face[face]).polygons())
      of_face[face].push_back({face, std::move(polygon)});
  });
  std::vector<ShadowFace> all;
  for (auto& some : of_face)
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  return all;
}

}  // namespace hybrid::stages
