#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "device/queue.hpp"
#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Rings of contour points around the masks of one label: half-way between a node inside and one outside, in
// (azimuth, elevation), rad; the azimuth is that of the columns' table extended beyond its ends. The mask is
// on the right as the image is seen, which is counter-clockwise as the scanner sees it for an outer ring.
using AngleRing = std::vector<std::array<double, 2>>;

// Cells of one label with their marching-squares code, in ascending order of cell.
struct LabelCells {
  struct Cell {
    std::uint64_t index;  // row * cols + col
    std::uint32_t code;   // set of corners inside: 1 upper left, 2 upper right, 4 lower right, 8 lower left
  };
  std::vector<Cell> cells;
};

// All cells of the image: cell (row, col) lies between nodes (row - 1, col - 1) and (row, col); rows + 1
// rows; cols columns when the image wraps, else cols + 1.
struct ContourCells {
  int rows = 0, cols = 0;
  std::vector<LabelCells> of_label;  // [id - 1]
};

// Kernel contour_cells over tiles. Outside the image lies no label, with one exception: where the image
// wraps, its first or last row is within two steps of the pole and wholly of one label, the pole belongs to
// that label, so that a ceiling's only boundary is its lower edge.
ContourCells find_contour_cells(device::Queue& queue, const RangeImage& image,
                                const std::vector<std::uint32_t>& labels, std::size_t label_count, int tile);

// Closed rings through the cells of one label; diagonal neighbours (saddles) are not connected.
std::vector<AngleRing> trace_rings(const RangeImage& image, const ContourCells& grid,
                                   const LabelCells& label);

}  // namespace hybrid::stages
