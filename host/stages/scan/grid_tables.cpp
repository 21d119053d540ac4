#include "stages/scan/grid_tables.hpp"

#include <algorithm>
#include <cmath>

#include "core/median.hpp"
#include "core/parallel.hpp"
#include "geometry/angles.hpp"
#include "stages/scan/sweeps.hpp"

namespace hybrid::stages {
namespace {

constexpr double kOneWay = 0.9;  // of a table's steps that must go one way

// Calls take(point) for the returns of a row or column of `count` nodes, of which node(k, point) finds the
// k-th: for some of them evenly spread, enough for a median, or for all where these hold few returns.
template <typename Node, typename Take>
void for_some_returns(int count, const Node& node, const Take& take) {
  constexpr int kSome = 128, kFew = 16;
  const auto visit = [&](int first, int stride) {
    int returns = 0;
    for (int k = first; k < count; k += stride) {
      Vec3 point;
      if (!node(k, point)) continue;
      take(point);
      ++returns;
    }
    return returns;
  };
  const int stride = std::max(count / kSome, 1);
  if (visit(stride / 2, stride) >= kFew || stride == 1) return;
  for (int first = 0; first < stride; ++first)
    if (first != stride / 2) visit(first, stride);
}

std::vector<double> row_elevations(const NodePoints& nodes) {
  std::vector<double> table(static_cast<std::size_t>(nodes.rows()));
  parallel_for(table.size(), [&](std::size_t row) {
    std::vector<double> values;
    for_some_returns(
        nodes.cols(), [&](int col, Vec3& p) { return nodes.find(static_cast<int>(row), col, p); },
        [&](const Vec3& p) { values.push_back(std::atan2(p.z(), std::hypot(p.x(), p.y()))); });
    table[row] = median(values);
  });
  return table;
}

// Medians of offsets from the column's mean direction, then unwrapped from one measured column to the next.
std::vector<double> column_azimuths(const NodePoints& nodes) {
  std::vector<double> table(static_cast<std::size_t>(nodes.cols()));
  parallel_for(table.size(), [&](std::size_t col) {
    Vec2 sum = Vec2::Zero();
    std::vector<double> azimuths;
    for_some_returns(
        nodes.rows(), [&](int row, Vec3& p) { return nodes.find(row, static_cast<int>(col), p); },
        [&](const Vec3& p) {
          sum += p.head<2>() / p.norm();
          azimuths.push_back(std::atan2(p.y(), p.x()));
        });
    const double mean = std::atan2(sum.y(), sum.x());
    for (double& azimuth : azimuths) azimuth = wrapped(azimuth - mean);
    table[col] = mean + median(azimuths);
  });
  double before = NAN;
  for (double& azimuth : table) {
    if (std::isnan(azimuth)) continue;
    if (!std::isnan(before)) azimuth = before + wrapped(azimuth - before);
    before = azimuth;
  }
  return table;
}

// Median angle between the rays of neighbours `row_step` rows and `col_step` columns apart.
double typical_angle(const NodePoints& nodes, int row_step, int col_step) {
  std::vector<double> found;
  for (int col = 0; col + col_step < nodes.cols(); ++col)
    for (int row = 0; row + row_step < nodes.rows(); ++row) {
      Vec3 p, q;
      if (!nodes.find(row, col, p) || !nodes.find(row + row_step, col + col_step, q)) continue;
      const double angle = std::atan2(p.cross(q).norm(), p.dot(q));
      if (angle > 0) found.push_back(angle);
    }
  const double typical = median(found);
  return std::isnan(typical) ? 0 : typical;
}

// A scrambled grid's neighbours may be a right angle apart: the table stays within a turn.
std::vector<double> even_table(int count, double step) {
  step = std::clamp(step, -kTurn / count, kTurn / count);
  std::vector<double> table;
  for (int i = 0; i < count; ++i) table.push_back((i - 0.5 * (count - 1)) * step);
  return table;
}

}  // namespace

int complete_table(std::vector<double>& table) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (!std::isnan(table[i])) known.push_back(i);
  if (known.size() < 2) return 0;
  const double mean_step =
      (table[known.back()] - table[known.front()]) / static_cast<double>(known.back() - known.front());
  for (std::size_t k = 1; k < known.size(); ++k) {
    const std::size_t a = known[k - 1], b = known[k];
    for (std::size_t i = a + 1; i < b; ++i)
      table[i] = table[a] + (table[b] - table[a]) * static_cast<double>(i - a) / static_cast<double>(b - a);
  }
  const std::size_t first = known.front(), last = known.back();
  for (std::size_t i = 0; i < first; ++i)
    table[i] = table[first] - mean_step * static_cast<double>(first - i);
  for (std::size_t i = last + 1; i < table.size(); ++i)
    table[i] = table[last] + mean_step * static_cast<double>(i - last);
  std::size_t up = 0, down = 0;
  for (std::size_t i = 1; i < table.size(); ++i) {
    up += table[i] > table[i - 1];
    down += table[i] < table[i - 1];
  }
  const std::size_t steps = table.size() - 1;
  if (static_cast<double>(std::max(up, down)) < kOneWay * static_cast<double>(steps)) return 0;
  if (std::max(up, down) < steps) {  // noise about an even table
    const double from = table.front(), step = (table.back() - from) / static_cast<double>(steps);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = from + step * static_cast<double>(i);
  }
  return up > down ? 1 : -1;
}

std::optional<GridTables> angle_tables(const NodePoints& nodes) {
  GridTables tables{.elevation_rad = row_elevations(nodes), .azimuth_rad = column_azimuths(nodes)};
  const int rows_go = complete_table(tables.elevation_rad), cols_go = complete_table(tables.azimuth_rad);
  const double turn = tables.azimuth_rad.back() - tables.azimuth_rad.front();
  if (rows_go == 0 || cols_go == 0 || std::abs(turn) > 1.1 * kTurn) return std::nullopt;
  tables.flip_rows = rows_go > 0;
  tables.flip_cols = cols_go < 0;
  if (tables.flip_rows) std::reverse(tables.elevation_rad.begin(), tables.elevation_rad.end());
  if (tables.flip_cols) std::reverse(tables.azimuth_rad.begin(), tables.azimuth_rad.end());
  return tables;
}

GridTables even_tables(const NodePoints& nodes) {
  return {.elevation_rad = even_table(nodes.rows(), -typical_angle(nodes, 1, 0)),
          .azimuth_rad = even_table(nodes.cols(), typical_angle(nodes, 0, 1)),
          .even = true};
}

}  // namespace hybrid::stages
