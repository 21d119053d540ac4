#pragma once
#include <cstddef>
#include <functional>
#include <optional>

#include "stages/scan/grid_tables.hpp"

namespace hybrid::stages {

// How an organised file's grid lies. Programs differ in what they call a row, and a mirror that sweeps a full
// circle writes what lies behind the scanner into the columns of what lies before it.
enum class GridLayout {
  as_filed,            // rows are elevations, columns azimuths
  transposed,          // columns are elevations, rows azimuths
  dimensions_swapped,  // the header has the numbers of rows and columns the other way round
  other_order,         // samples go along the rows in a format that goes down the columns, or the reverse
  over_zenith,         // a column goes up before the scanner, over the zenith and down behind it
  no_angles            // none of these: a camera's image, or the scanner is not at the origin
};

// Order of the samples in a file whose grid has one for each node; none where the file says a sample's node.
using SampleOrder = std::optional<bool>;  // true: row by row

// A grid of elevations and azimuths made from the file's, whose tables it has.
struct LaidOutGrid {
  struct Place {
    int row, col;  // row -1: nothing is there
  };
  GridLayout layout = GridLayout::as_filed;
  GridTables tables;
  int rows = 0, cols = 0;
  // Where in the file's grid a node is from, before `tables` turn the grid; empty: the same place.
  std::function<Place(int row, int col)> from;
};

// The first layout, in the order above, whose rows and columns are angles about Z. Else `no_angles`, with
// even tables.
LaidOutGrid lay_out_grid(const NodePoints& nodes, SampleOrder order);

}  // namespace hybrid::stages
