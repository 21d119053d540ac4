#include "stages/rendering/shadow_faces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/parallel.hpp"
#include "stages/rendering/flat_polygon.hpp"

namespace hybrid::stages {
namespace {

constexpr double kCell_m = 0.02;
constexpr int kMostCells = 256;           // across a polygon: of a larger one they are larger
constexpr double kMostSeenThrough = 0.2;  // of a part's border
constexpr double kLeastHidden = 0.5;      // of a part: of the rest no scan says anything
constexpr int kLeastCells = 4;            // of a part
constexpr double kSmallHole_m2 = 0.02;    // in which nothing was measured
constexpr std::array<std::pair<int, int>, 4> kFourBeside = {{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};

// What the scans say of a cell of a polygon's plane.
enum class Cell : std::uint8_t { kUnsure, kSeen, kHidden, kEmpty };

class Shadow {
 public:
  Shadow(const ScanSight& sight, const FlatPolygon& polygon, std::size_t scan) : polygon_(polygon) {
    const Vec2 size = polygon.high() - polygon.low();
    step_ = std::max(kCell_m, size.maxCoeff() / kMostCells);
    cols_ = std::max(1, static_cast<int>(std::ceil(size.x() / step_)));
    rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / step_)));
    cells_.resize(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_), Cell::kUnsure);
    for (int row = 0; row < rows_; ++row) look(sight, scan, row);
  }

  // Corners of rectangles.
  std::vector<std::array<Vec3, 4>> rectangles() const {
    auto filled = between();
    keep_shadows(filled);
    overlap(filled);
    std::vector<std::array<Vec3, 4>> found;
    std::vector<Run> open;
    for (int row = 0; row <= rows_; ++row) {
      std::vector<Run> next = row < rows_ ? runs(filled, row) : std::vector<Run>{};
      for (const Run& run : open) {
        const auto same = std::find_if(next.begin(), next.end(), [&](const Run& other) {
          return other.begin == run.begin && other.end == run.end;
        });
        if (same != next.end())
          same->row = run.row;
        else
          found.push_back(rectangle(run, row));
      }
      open = std::move(next);
    }
    return found;
  }

 private:
  struct Run {
    int row, begin, end;  // the first row, columns
  };

  std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }
  bool is_in(int row, int col) const { return row >= 0 && col >= 0 && row < rows_ && col < cols_; }

  void look(const ScanSight& sight, std::size_t scan, int row) {
    const double y = polygon_.low().y() + (row + 0.5) * step_;
    for (const auto& [from, to] : polygon_.spans(y)) {
      const int first = static_cast<int>(std::ceil((from - polygon_.low().x()) / step_ - 0.5));
      const int last = static_cast<int>(std::floor((to - polygon_.low().x()) / step_ - 0.5));
      for (int col = std::max(first, 0); col <= std::min(last, cols_ - 1); ++col)
        cells_[at(row, col)] = Cell::kSeen;
    }
    for (int col = 0; col < cols_; ++col) {
      Cell& cell = cells_[at(row, col)];
      if (cell == Cell::kSeen) continue;
      const Vec3 place = polygon_.lifted({polygon_.low().x() + (col + 0.5) * step_, y});
      if (sight.is_hidden(place, scan)) cell = Cell::kHidden;
      if (sight.is_empty(place)) cell = Cell::kEmpty;
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
        if (empty == 0 && static_cast<double>(part.size()) * step_ * step_ <= kSmallHole_m2) continue;
        for (const auto& [r, c] : part) filled[at(r, c)] = 0;
      }
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

  std::vector<Run> runs(const std::vector<std::uint8_t>& filled, int row) const {
    std::vector<Run> found;
    for (int col = 0; col < cols_; ++col) {
      if (!filled[at(row, col)]) continue;
      const int begin = col;
      while (col < cols_ && filled[at(row, col)]) ++col;
      found.push_back({row, begin, col});
    }
    return found;
  }

  std::array<Vec3, 4> rectangle(const Run& run, int end) const {
    const auto corner = [&](int col, int row) {
      return polygon_.lifted(polygon_.low() + step_ * Vec2(col, row));
    };
    return {corner(run.begin, run.row), corner(run.end, run.row), corner(run.end, end),
            corner(run.begin, end)};
  }

  const FlatPolygon& polygon_;
  double step_ = kCell_m;
  int rows_ = 0, cols_ = 0;
  std::vector<Cell> cells_;  // the lowest row first
};

}  // namespace

std::vector<ShadowFace> shadow_faces(const ScanSight& sight, const PolygonModel& contours,
                                     const std::vector<std::size_t>& scan_of_face) {
  std::vector<std::vector<ShadowFace>> of_face(contours.faces.size());
  parallel_for(of_face.size(), [&](std::size_t face) {
    const FlatPolygon polygon(polygon_of(contours, contours.faces[face]));
    for (const auto& corners : Shadow(sight, polygon, scan_of_face[face]).rectangles())
      of_face[face].push_back({face, corners});
  });
  std::vector<ShadowFace> all;
  for (const auto& some : of_face) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace hybrid::stages
