#pragma once
#include <cstdint>

#include "geometry/range_image.hpp"
#include "stages/planes/square_planes.hpp"

namespace hybrid::stages {

// Neighbourhood on the grid of squares, across the azimuth seam where the image wraps.
struct SquareGrid {
  static constexpr std::int64_t kNone = -1;
  enum Direction { kRight, kLower, kLeft, kUpper };

  int rows = 0, cols = 0;
  bool wraps = false;

  SquareGrid(const RangeImage& image, const SquarePlanes& squares)
      // With two columns of squares the seam would join the same pair twice.
      : rows(squares.rows), cols(squares.cols), wraps(image.wraps && squares.cols > 2) {}

  std::size_t count() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  // Index of the square at an offset, or kNone.
  std::int64_t at(int row, int col) const {
    if (wraps) {  // no division: it is asked of every neighbour
      while (col < 0) col += cols;
      while (col >= cols) col -= cols;
    }
    if (row < 0 || row >= rows || col < 0 || col >= cols) return kNone;
    return static_cast<std::int64_t>(row) * cols + col;
  }
  std::int64_t neighbour(std::size_t square, int direction) const {
    const int row = static_cast<int>(square / static_cast<std::size_t>(cols));
    const int col = static_cast<int>(square % static_cast<std::size_t>(cols));
    return at(row + (direction == kLower) - (direction == kUpper),
              col + (direction == kRight) - (direction == kLeft));
  }
};

}  // namespace hybrid::stages
