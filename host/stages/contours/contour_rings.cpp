#include "stages/contours/contour_rings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "shared/params_contour_cells.h"

namespace hybrid::stages {
namespace {

// The label all nodes of a row have, when the row is next to a pole of a full turn; else 0.
std::uint32_t pole_label(const RangeImage& image, const std::vector<std::uint32_t>& labels, int row) {
  const double gap = std::numbers::pi / 2 - std::abs(image.elevation_rad[static_cast<std::size_t>(row)]);
  if (!image.wraps || gap > 2.001 * std::abs(image.elevation_step_rad())) return 0;
  const auto begin = labels.begin() + static_cast<std::ptrdiff_t>(image.index(row, 0));
  const bool uniform = std::all_of(begin, begin + image.cols, [&](std::uint32_t l) { return l == *begin; });
  return uniform ? *begin : 0;
}

// Nodes of the tile's cells: one row and one column more than cells.
std::vector<std::uint32_t> gather_nodes(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                                        std::uint32_t upper_pole, std::uint32_t lower_pole,
                                        const Tile& tile) {
  const std::size_t width = static_cast<std::size_t>(tile.cols) + 1;
  std::vector<std::uint32_t> nodes((static_cast<std::size_t>(tile.rows) + 1) * width);
  parallel_for(static_cast<std::size_t>(tile.rows) + 1, [&](std::size_t r) {
    const int row = tile.row - 1 + static_cast<int>(r);
    for (std::size_t c = 0; c < width; ++c) {
      int col = tile.col - 1 + static_cast<int>(c);
      col = image.wrapped(col);
      std::uint32_t label = 0;
      if (row < 0)
        label = upper_pole;
      else if (row >= image.rows)
        label = lower_pole;
      else if (col >= 0 && col < image.cols)
        label = labels[image.index(row, col)];
      nodes[r * width + c] = label;
    }
  });
  return nodes;
}

// Edges of a cell, clockwise as the image is seen: edge k lies between corners k and k + 1.
enum CellEdge { kUpperEdge, kRightEdge, kLowerEdge, kLeftEdge };

bool inside(std::uint32_t code, int corner) {
  return (code >> (corner & 3) & 1u) != 0;
}

// A contour leaves its mask to the right: through a cell it runs from an edge where, clockwise, inside turns
// to outside, back over the inside corners to the edge where they began.
bool starts_at(std::uint32_t code, int edge) {
  return inside(code, edge) && !inside(code, edge + 1);
}
int end_of(std::uint32_t code, int edge) {
  int corner = edge;
  while (inside(code, corner + 3)) corner = (corner + 3) & 3;
  return (corner + 3) & 3;
}

struct Tracer {
  const RangeImage& image;
  const ContourCells& grid;
  const std::vector<LabelCells::Cell>& cells;
  std::vector<std::uint8_t> visited;  // per cell: set of start edges

  std::size_t find(std::uint64_t index) const {
    const auto at =
        std::lower_bound(cells.begin(), cells.end(), index,
                         [](const auto& cell, std::uint64_t value) { return cell.index < value; });
    return static_cast<std::size_t>(at - cells.begin());
  }

  double elevation(int row) const {
    const auto& table = image.elevation_rad;
    if (row < 0) return table.front() + image.elevation_step_rad();
    if (row >= image.rows) return table.back() - image.elevation_step_rad();
    return table[static_cast<std::size_t>(row)];
  }
  double azimuth(int col) const {
    const auto& table = image.azimuth_rad;
    if (col >= 0 && col < image.cols) return table[static_cast<std::size_t>(col)];
    if (image.wraps)
      return col < 0 ? table.back() - 2 * std::numbers::pi : table.front() + 2 * std::numbers::pi;
    return col < 0 ? table.front() - image.azimuth_step_rad() : table.back() + image.azimuth_step_rad();
  }
  std::array<double, 2> point(int row, int col, int edge) const {
    switch (edge) {
      case kUpperEdge:
        return {(azimuth(col - 1) + azimuth(col)) / 2, elevation(row - 1)};
      case kRightEdge:
        return {azimuth(col), (elevation(row - 1) + elevation(row)) / 2};
      case kLowerEdge:
        return {(azimuth(col - 1) + azimuth(col)) / 2, elevation(row)};
      default:
        return {azimuth(col - 1), (elevation(row - 1) + elevation(row)) / 2};
    }
  }

  AngleRing ring(std::size_t cell, int edge) {
    AngleRing points;
    while (!(visited[cell] >> edge & 1)) {
      visited[cell] = static_cast<std::uint8_t>(visited[cell] | 1 << edge);
      int row = static_cast<int>(cells[cell].index / static_cast<std::uint64_t>(grid.cols));
      int col = static_cast<int>(cells[cell].index % static_cast<std::uint64_t>(grid.cols));
      const int end = end_of(cells[cell].code, edge);
      points.push_back(point(row, col, end));
      row += (end == kLowerEdge) - (end == kUpperEdge);
      col += (end == kRightEdge) - (end == kLeftEdge);
      if (image.wraps) col = (col + grid.cols) % grid.cols;
      cell = find(static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(grid.cols) +
                  static_cast<std::uint64_t>(col));
      edge = (end + 2) & 3;
    }
    return points;
  }
};

}  // namespace

ContourCells find_contour_cells(device::Queue& queue, const RangeImage& image,
                                const std::vector<std::uint32_t>& labels, std::size_t label_count, int tile) {
  ContourCells grid;
  grid.rows = image.rows + 1;
  grid.cols = image.wraps ? image.cols : image.cols + 1;
  grid.of_label.resize(label_count);
  if (image.count() == 0) return grid;
  const std::uint32_t upper = pole_label(image, labels, 0), lower = pole_label(image, labels, image.rows - 1);
  const auto width = static_cast<std::size_t>(grid.cols);
  std::vector<std::uint16_t> codes(static_cast<std::size_t>(grid.rows) * width);
  for (const Tile& part : make_tiles(grid.rows, grid.cols, tile)) {
    const device::Rect rect{static_cast<std::size_t>(part.row), static_cast<std::size_t>(part.col),
                            static_cast<std::size_t>(part.rows), static_cast<std::size_t>(part.cols)};
    ContourCellParams params{};
    params.rows = static_cast<std::uint32_t>(part.rows);
    params.cols = static_cast<std::uint32_t>(part.cols);
    const auto nodes = queue.array(gather_nodes(image, labels, upper, lower, part));
    auto tile_codes = queue.array<std::uint16_t>(rect.rows * rect.cols);
    queue.launch("contour_cells", queue.kernel("contour_cells"), device::grid(rect.cols, rect.rows), params,
                 nodes, tile_codes);
    queue.read_rect(tile_codes, codes.data(), width, rect);
  }
  const auto label_at = [&](int row, int col) -> std::uint32_t {
    if (row < 0) return upper;
    if (row >= image.rows) return lower;
    col = image.wrapped(col);
    return col < 0 || col >= image.cols ? 0 : labels[image.index(row, col)];
  };
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (codes[i] == 0 || codes[i] == 0xffff) continue;
    const int row = static_cast<int>(i / width), col = static_cast<int>(i % width);
    const std::uint32_t corner[4] = {label_at(row - 1, col - 1), label_at(row - 1, col), label_at(row, col),
                                     label_at(row, col - 1)};
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t code = codes[i] >> (4 * k) & 15u;
      // Each label once: by its first corner.
      if (code != 0 && (code & ((1u << k) - 1)) == 0) grid.of_label[corner[k] - 1].cells.push_back({i, code});
    }
  }
  return grid;
}

std::vector<AngleRing> trace_rings(const RangeImage& image, const ContourCells& grid,
                                   const LabelCells& label) {
  Tracer tracer{image, grid, label.cells, std::vector<std::uint8_t>(label.cells.size())};
  std::vector<AngleRing> rings;
  for (std::size_t cell = 0; cell < label.cells.size(); ++cell)
    for (int edge = 0; edge < 4; ++edge)
      if (starts_at(label.cells[cell].code, edge) && !(tracer.visited[cell] >> edge & 1))
        rings.push_back(tracer.ring(cell, edge));
  return rings;
}

}  // namespace hybrid::stages
