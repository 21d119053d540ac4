#include "stages/rendering/cell_outlines.hpp"

#include <array>

namespace hybrid::stages {
namespace {

// Directions of the border's edges, each a quarter turn to the left of the one before.
constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};  // x, y

class Tracer {
 public:
  Tracer(const std::vector<std::uint8_t>& set, int cols)
      : set_(set), cols_(cols), rows_(cols > 0 ? static_cast<int>(set.size()) / cols : 0) {
    leaving_.resize(static_cast<std::size_t>(rows_ + 1) * static_cast<std::size_t>(cols_ + 1));
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        if (!is_set(row, col)) continue;
        if (!is_set(row - 1, col)) leave(col, row, 0);
        if (!is_set(row, col + 1)) leave(col + 1, row, 1);
        if (!is_set(row + 1, col)) leave(col + 1, row + 1, 2);
        if (!is_set(row, col - 1)) leave(col, row + 1, 3);
      }
  }

  std::vector<CellOutline> outlines() {
    number_parts();
    std::vector<CellOutline> found(static_cast<std::size_t>(parts_));
    for (int row = 0; row <= rows_; ++row)
      for (int col = 0; col <= cols_; ++col)
        for (int direction = 0; direction < 4; ++direction)
          if (leaving_[corner(col, row)] >> direction & 1) {
            const int part = part_left_of(col, row, direction);
            Ring2 ring = trace(col, row, direction);
            CellOutline& outline = found[static_cast<std::size_t>(part)];
            if (signed_area(ring) > 0)
              outline.outer = std::move(ring);
            else
              outline.holes.push_back(std::move(ring));
          }
    return found;
  }

 private:
  std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
  }
  std::size_t corner(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_ + 1) +
           static_cast<std::size_t>(col);
  }
  bool is_set(int row, int col) const {
    return row >= 0 && col >= 0 && row < rows_ && col < cols_ && set_[at(row, col)] != 0;
  }
  void leave(int col, int row, int direction) {
    leaving_[corner(col, row)] |= static_cast<std::uint8_t>(1 << direction);
  }

  void number_parts() {
    part_.assign(set_.size(), -1);
    std::vector<std::array<int, 2>> next;
    for (int row = 0; row < rows_; ++row)
      for (int col = 0; col < cols_; ++col) {
        if (!is_set(row, col) || part_[at(row, col)] >= 0) continue;
        part_[at(row, col)] = parts_;
        next.assign(1, {row, col});
        while (!next.empty()) {
          const auto [r, c] = next.back();
          next.pop_back();
          for (const auto& [x, y] : kSteps)
            if (is_set(r + y, c + x) && part_[at(r + y, c + x)] < 0) {
              part_[at(r + y, c + x)] = parts_;
              next.push_back({r + y, c + x});
            }
        }
        ++parts_;
      }
  }

  // Of the cell to the left of an edge.
  int part_left_of(int col, int row, int direction) const {
    constexpr std::array<std::array<int, 2>, 4> kLeft = {{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};  // x, y
    const auto& [x, y] = kLeft[static_cast<std::size_t>(direction)];
    return part_[at(row + y, col + x)];
  }

  // Around once, the set cells on the left, and takes the edges away. Where two cells touch at a corner it
  // stays with its own: it turns left.
  Ring2 trace(int col, int row, int direction) {
    Ring2 ring;
    const std::array start = {col, row, direction};
    int before = -1;
    do {
      if (direction != before) ring.emplace_back(col, row);
      before = direction;
      leaving_[corner(col, row)] &= static_cast<std::uint8_t>(~(1 << direction));
      col += kSteps[static_cast<std::size_t>(direction)][0];
      row += kSteps[static_cast<std::size_t>(direction)][1];
      for (const int turn : {1, 0, 3}) {
        const int next = (direction + turn) % 4;
        if (!(leaving_[corner(col, row)] >> next & 1) && std::array{col, row, next} != start) continue;
        direction = next;
        break;
      }
    } while (std::array{col, row, direction} != start);
    return ring;
  }

  const std::vector<std::uint8_t>& set_;
  int cols_, rows_;
  std::vector<std::uint8_t> leaving_;  // per corner, a bit per direction
  std::vector<int> part_;              // per cell, -1: not set
  int parts_ = 0;
};

}  // namespace

std::vector<CellOutline> cell_outlines(const std::vector<std::uint8_t>& set, int cols) {
  return Tracer(set, cols).outlines();
}

}  // namespace hybrid::stages
