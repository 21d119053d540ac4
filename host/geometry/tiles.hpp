#pragma once
#include <algorithm>
#include <vector>

namespace hybrid {

// A rectangle of rows and columns of a range image.
struct Tile {
  int row = 0, col = 0, rows = 0, cols = 0;
};

// Covers rows x cols with tiles of at most `side` rounded down to a multiple of `multiple` (at least one
// multiple), all anchored at (0,0), so that no square of side `multiple` straddles two tiles. Row by row,
// left to right.
inline std::vector<Tile> make_tiles(int rows, int cols, int side, int multiple = 1) {
  const int step = std::max(side / multiple, 1) * multiple;
  std::vector<Tile> tiles;
  for (int row = 0; row < rows; row += step)
    for (int col = 0; col < cols; col += step)
      tiles.push_back({row, col, std::min(step, rows - row), std::min(step, cols - col)});
  return tiles;
}

}  // namespace hybrid
