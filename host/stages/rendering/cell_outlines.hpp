#pragma once
#include <cstdint>
#include <vector>

#include "geometry/flat_ring.hpp"

namespace hybrid::stages {

// The border of cells that touch along their sides, corner by corner where it turns: cell (row, col) goes
// from (col, row) to (col + 1, row + 1). The outer ring counter-clockwise, holes clockwise.
struct CellOutline {
  Ring2 outer;
  std::vector<Ring2> holes;
};

// Of each connected part of the cells that are set, `cols` to a row; cells that touch at a corner alone are
// not connected. In the order of the parts' first cells.
std::vector<CellOutline> cell_outlines(const std::vector<std::uint8_t>& set, int cols);

}  // namespace hybrid::stages
