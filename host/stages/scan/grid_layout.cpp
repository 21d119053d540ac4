#include "stages/scan/grid_layout.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/median.hpp"
#include "core/parallel.hpp"
#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

using Place = LaidOutGrid::Place;
using From = std::function<Place(int row, int col)>;

// The points of a grid by the rows and columns of another.
class RelaidNodes : public NodePoints {
 public:
  RelaidNodes(const NodePoints& nodes, int rows, int cols, const From& from)
      : NodePoints(rows, cols), nodes_(nodes), from_(from) {}
  bool find(int row, int col, Vec3& point) const override {
    const Place place = from_(row, col);
    return place.row >= 0 && nodes_.find(place.row, place.col, point);
  }

 private:
  const NodePoints& nodes_;
  const From& from_;
};

// Of several of a column, about this many rows.
constexpr int kRowsOfColumn = 128;

// A column's axis: the direction, modulo half a turn, that its points lie along on the ground.
double axis_of(const NodePoints& nodes, int col) {
  double sine = 0, cosine = 0;
  for (int row = 0; row < nodes.rows(); row += std::max(nodes.rows() / kRowsOfColumn, 1)) {
    Vec3 p;
    if (!nodes.find(row, col, p)) continue;
    const double twice = 2 * std::atan2(p.y(), p.x());
    const double weight = p.head<2>().squaredNorm() / p.squaredNorm();
    sine += weight * std::sin(twice);
    cosine += weight * std::cos(twice);
  }
  return sine == 0 && cosine == 0 ? NAN : 0.5 * std::atan2(sine, cosine);
}

// The angle of each row along the sweep, in [-90, 270) degrees: over 90 it is behind the scanner.
std::vector<double> sweep_angles(const NodePoints& nodes) {
  std::vector<double> axes(static_cast<std::size_t>(nodes.cols()));
  parallel_for(axes.size(), [&](std::size_t col) { axes[col] = axis_of(nodes, static_cast<int>(col)); });
  double before = NAN;
  for (double& axis : axes) {  // of its two directions the one nearer to the last column's
    if (std::isnan(axis)) continue;
    if (!std::isnan(before)) axis = before + std::remainder(axis - before, kTurn / 2);
    before = axis;
  }
  std::vector<double> table(static_cast<std::size_t>(nodes.rows()));
  const int stride = std::max(nodes.cols() / kRowsOfColumn, 1);
  parallel_for(table.size(), [&](std::size_t row) {
    std::vector<double> angles;
    for (int col = 0; col < nodes.cols(); col += stride) {
      Vec3 p;
      const double axis = axes[static_cast<std::size_t>(col)];
      if (std::isnan(axis) || !nodes.find(static_cast<int>(row), col, p)) continue;
      const double angle = std::atan2(p.z(), p.x() * std::cos(axis) + p.y() * std::sin(axis));
      angles.push_back(angle < -kTurn / 4 ? angle + kTurn : angle);
    }
    table[row] = median(angles);
  });
  return table;
}

// The file's rows that are one row of the grid, before and behind the scanner.
std::vector<std::pair<int, int>> rows_over_zenith(const NodePoints& nodes) {
  std::vector<double> angles = sweep_angles(nodes);
  const int goes = complete_table(angles);
  if (goes == 0) return {};
  const bool upwards = goes > 0;
  const auto zenith = static_cast<int>(
      std::count_if(angles.begin(), angles.end(), [&](double a) { return (a < kTurn / 4) == upwards; }));
  const int count = nodes.rows();
  std::vector<std::pair<int, int>> rows;  // -1: none
  for (int k = 0; k < std::max(zenith, count - zenith); ++k)
    rows.emplace_back(k < zenith ? zenith - 1 - k : -1, zenith + k < count ? zenith + k : -1);
  constexpr int kFew = 2;  // beyond the zenith even where a column ends there
  return std::min(zenith, count - zenith) > kFew ? rows : std::vector<std::pair<int, int>>{};
}

}  // namespace

LaidOutGrid lay_out_grid(const NodePoints& nodes, SampleOrder order) {
  const int rows = nodes.rows(), cols = nodes.cols();
  if (auto tables = angle_tables(nodes)) return {GridLayout::as_filed, *std::move(tables), rows, cols, {}};
  std::optional<LaidOutGrid> found;
  const auto try_layout = [&](GridLayout layout, int new_rows, int new_cols, const From& from) {
    if (found) return;
    if (auto tables = angle_tables(RelaidNodes(nodes, new_rows, new_cols, from)))
      found = {layout, *std::move(tables), new_rows, new_cols, from};
  };
  try_layout(GridLayout::transposed, cols, rows, [](int row, int col) { return Place{col, row}; });
  if (order) {
    const bool by_row = *order;
    const auto place_of = [=](std::int64_t sample) {
      const int fast = by_row ? cols : rows;
      const auto along = static_cast<int>(sample % fast), across = static_cast<int>(sample / fast);
      return by_row ? Place{across, along} : Place{along, across};
    };
    try_layout(GridLayout::dimensions_swapped, cols, rows, [=](int row, int col) {
      return place_of(by_row ? std::int64_t{row} * rows + col : std::int64_t{col} * cols + row);
    });
    try_layout(GridLayout::other_order, rows, cols, [=](int row, int col) {
      return place_of(by_row ? std::int64_t{col} * rows + row : std::int64_t{row} * cols + col);
    });
  }
  if (!found)
    if (const auto halves = rows_over_zenith(nodes); !halves.empty())
      try_layout(GridLayout::over_zenith, static_cast<int>(halves.size()), 2 * cols, [=](int row, int col) {
        const auto [before, behind] = halves[static_cast<std::size_t>(row)];
        return col < cols ? Place{before, col} : Place{behind, col - cols};
      });
  if (found) return *std::move(found);
  return {GridLayout::no_angles, even_tables(nodes), rows, cols, {}};
}

}  // namespace hybrid::stages
