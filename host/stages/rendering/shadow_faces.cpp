#include "stages/rendering/shadow_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include "core/parallel.hpp"
#include "stages/rendering/cell_outlines.hpp"
#include "stages/rendering/shadow_corners.hpp"

namespace hybrid::stages {
namespace {

constexpr double kCell_m = 0.02;
constexpr int kMostCells = 256;           // across a polygon: of a larger one they are larger
constexpr double kMostSeenThrough = 0.2;  // of a part's border
constexpr double kLeastHidden = 0.5;      // of a part: of the rest no scan says anything
constexpr int kLeastCells = 4;            // of a part
constexpr double kNarrowHole_m = 0.14;    // in which nothing was measured
constexpr double kLeastBars = 0.25;       // of a narrow hole's border, where others lie beside it
constexpr double kStairs = 0.75;          // of a cell: what is left of stairs is straight
constexpr double kSameGround_m = 0.2;     // between parts of one surface
constexpr double kOneNormal = 1 - 1e-6, kOnePlane_m = 1e-3;  // of polygons of one plane
constexpr std::array<std::pair<int, int>, 4> kFourBeside = {{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};

// What the scans say of a cell of a polygon's plane.
enum class Cell : std::uint8_t { kUnsure, kSeen, kHidden, kEmpty };

class Shadow {
 public:
  // `foot_m`: how far below the polygon it may go on. `before`, `beyond`: what may hide the scan's view of
  // its plane at its sides.
  Shadow(const ScanSight& sight, const FlatPolygon& polygon, double foot_m, std::size_t scan,
         const std::optional<BodyBeside>& before, const std::optional<BodyBeside>& beyond)
      : polygon_(polygon),
        eye_(sight.scans()[scan].world_from_scan.translation),
        low_(polygon.low() - Vec2(0, foot_m)) {
    const Vec2 size = polygon.high() - low_;
    step_ = std::max(kCell_m, size.maxCoeff() / kMostCells);
    const auto steps = [&](double length) { return std::ceil(length / step_); };
    if (before) low_.x() -= step_ * steps(low_.x() - before->corner);
    const double right = beyond ? beyond->corner : polygon.high().x();
    cols_ = std::max(1, static_cast<int>(steps(right - low_.x())));
    rows_ = std::max(1, static_cast<int>(steps(size.y())));
    cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_), Cell::kUnsure);
    for (int row = 0; row < rows_; ++row) look(sight, scan, row);
    doubt_single_beams();
    between();
    if (before) pass_behind(*before, 0, 1);
    if (beyond) pass_behind(*beyond, cols_ - 1, -1);
  }

  std::vector<PolygonModel> polygons() const {
    auto filled = unseen_;
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

  Vec3 place_at(int row, int col) const { return polygon_.lifted(low_ + step_ * Vec2(col + 0.5, row + 0.5)); }

  void look(const ScanSight& sight, std::size_t scan, int row) {
    const double y = low_.y() + (row + 0.5) * step_;
    for (const auto& [from, to] : polygon_.spans(y)) {
      const int first = static_cast<int>(std::ceil((from - low_.x()) / step_ - 0.5));
      const int last = static_cast<int>(std::floor((to - low_.x()) / step_ - 0.5));
      for (int col = std::max(first, 0); col <= std::min(last, cols_ - 1); ++col)
        cells_[at(row, col)] = Cell::kSeen;
    }
    SightWalk walk(sight);
    for (int col = 0; col < cols_; ++col) {
      Cell& cell = cells_[at(row, col)];
      if (cell == Cell::kSeen) continue;
      const Vec3 place = place_at(row, col);
      if (sight.is_hidden(place, scan)) cell = Cell::kHidden;
      if (walk.known(place) == ScanSight::Known::empty) cell = Cell::kEmpty;
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

  void between() {
    unseen_.assign(cells_.size(), 0);
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        const Cell cell = cells_[at(row, col)];
        if (cell == Cell::kSeen || cell == Cell::kEmpty) continue;
        const auto seen = [&](int up, int across) { return end_of(row, col, up, across) == Cell::kSeen; };
        const bool stands = !polygon_.is_level() && end_of(row, col, -1, 0) == Cell::kUnsure;
        unseen_[at(row, col)] = (seen(0, 1) && seen(0, -1)) || (seen(1, 0) && (stands || seen(-1, 0)));
      }
  }

  // From a body's corner to what is seen, where the body hides all between.
  void pass_behind(const BodyBeside& body, int corner, int across) {
    for (int row = 0; row < rows_; ++row) {
      const auto is_behind = [&](int col) {
        return is_in(row, col) && cells_[at(row, col)] != Cell::kSeen &&
               cells_[at(row, col)] != Cell::kEmpty && body.hides(place_at(row, col), eye_);
      };
      // Of a cell on the corner the middle may be in the body.
      int end = is_behind(corner) ? corner : corner + across;
      while (is_behind(end)) end += across;
      if (!is_in(row, end) || cells_[at(row, end)] != Cell::kSeen) continue;
      for (int col = corner; col != end; col += across)
        if (cells_[at(row, col)] != Cell::kSeen && cells_[at(row, col)] != Cell::kEmpty)
          unseen_[at(row, col)] = 1;
    }
  }

  // Of the connected parts those that something hides and nothing looks through beside them.
  void keep_shadows(std::vector<std::uint8_t>& filled) const {
    const auto between = filled;
    std::vector<std::uint8_t> done(filled.size(), 0);
    std::vector<std::pair<int, int>> part;
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        if (!between[at(row, col)] || done[at(row, col)]) continue;
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
            if (!between[at(y, x)] || done[at(y, x)]) continue;
            done[at(y, x)] = 1;
            part.emplace_back(y, x);
          }
        }
        if (part.size() >= kLeastCells && share(hidden, part.size()) >= kLeastHidden &&
            share(empty, empty + seen) <= kMostSeenThrough)
          continue;
        if (empty == 0 && mean_width_m(part) <= kNarrowHole_m && !is_between_bars(part, between)) continue;
        for (const auto& [r, c] : part) filled[at(r, c)] = 0;
      }
  }

  static double share(std::size_t some, std::size_t all) {
    return static_cast<double>(some) / static_cast<double>(std::max<std::size_t>(all, 1));
  }

  // Whether what parts it from other holes is no wider than itself: a grille or a railing before the sky,
  // which returns no more than dark paint does.
  bool is_between_bars(const std::vector<std::pair<int, int>>& part,
                       const std::vector<std::uint8_t>& holes) const {
    const int widest = static_cast<int>(std::lround(mean_width_m(part) / step_));
    std::size_t seen = 0, bars = 0;
    for (const auto& [row, col] : part)
      for (const auto& [up, across] : kFourBeside) {
        int wide = 0, y = row + up, x = col + across;
        for (; wide <= widest && is_in(y, x) && cells_[at(y, x)] == Cell::kSeen; y += up, x += across) ++wide;
        if (wide == 0) continue;
        ++seen;
        bars += wide <= widest && is_in(y, x) && holes[at(y, x)];
      }
    return share(bars, seen) >= kLeastBars;
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
  Vec3 eye_;  // the scan that shows it
  Vec2 low_;
  double step_ = kCell_m;
  int rows_ = 0, cols_ = 0;
  std::vector<Cell> cells_;           // the lowest row first
  std::vector<std::uint8_t> unseen_;  // of them, where the plane may go on
};

// Upright ones.
bool are_in_one_plane(const FlatPolygon& own, const FlatPolygon& other) {
  const Vec3 apart = other.lifted(other.low()) - own.lifted(own.low());
  return !own.is_level() && own.normal().dot(other.normal()) > kOneNormal &&
         std::abs(own.normal().dot(apart)) < kOnePlane_m;
}

}  // namespace

std::vector<ShadowFace> shadow_faces(const ScanSight& sight, const PolygonModel& contours,
                                     const std::vector<std::size_t>& scan_of_face,
                                     const PolygonModel& model) {
  std::vector<BoxedPolygon> faces;  // the contours first
  for (const PolygonModel* some : {&contours, &model})
    for (const Face& face : some->faces) faces.emplace_back(polygon_of(*some, face));
  const std::size_t count = contours.faces.size();
  std::vector<double> own_foot_m(count, 0.0);
  parallel_for(count, [&](std::size_t face) {
    for (std::size_t other = 0; other < count; ++other)
      own_foot_m[face] = std::max(own_foot_m[face], goes_down_m(faces[face], faces[other]));
  });
  // Parts of one surface stand on the same ground.
  const auto foot_m = [&](std::size_t face) {
    const FlatPolygon& own = faces[face].flat;
    double most_m = own_foot_m[face];
    for (std::size_t other = 0; other < count; ++other)
      if (scan_of_face[other] == scan_of_face[face] &&
          faces[face].box.is_near(faces[other].box, kSameGround_m) &&
          are_in_one_plane(own, faces[other].flat)) {
        const FlatPolygon& part = faces[other].flat;
        const Vec3 foot = part.lifted(part.low() - Vec2(0, own_foot_m[other]));
        most_m = std::max(most_m, own.low().y() - own.flat(foot).y());
      }
    return most_m;
  };
  std::vector<std::vector<ShadowFace>> of_face(count);
  parallel_for(count, [&](std::size_t face) {
    const Shadow shadow(sight, faces[face].flat, foot_m(face), scan_of_face[face],
                        body_beside(faces[face], -1, faces), body_beside(faces[face], 1, faces));
    for (auto& polygon : shadow.polygons()) of_face[face].push_back({face, std::move(polygon)});
  });
  std::vector<ShadowFace> all;
  for (auto& some : of_face)
    all.insert(all.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  return all;
}

}  // namespace hybrid::stages
