#include "io/e57/scan_grid.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/large_vector.hpp"
#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kMostNodes = Scan::kNoNode - 1;

}  // namespace

std::uint64_t grid_nodes(std::uint64_t rows, std::uint64_t columns) {
  if (rows == 0 || columns == 0 || rows > kMostNodes / columns) return 0;
  return rows * columns;
}

std::string too_sparse(std::uint64_t rows, std::uint64_t columns, std::uint64_t samples) {
  if (rows * columns <= kMostNodesPerSample * samples + kFreeNodes) return {};
  return fmt::format("{} points on a grid of {} rows x {} columns: taken as not organised", samples, rows,
                     columns);
}

ScanGrid::ScanGrid(const E57Scan& scan, const ScanColumns& columns, std::uint64_t count) : columns_(columns) {
  if (!columns.row || count == 0) return;
  const auto field = [&](std::size_t slot) -> const E57Field& {
    return scan.points.fields[columns.fields[slot]];
  };
  usable_ = field(*columns.row).is_integer() && field(*columns.column).is_integer();
  if (!usable_) return;
  ranges_.resize((count + E57RecordReader::kRange - 1) / E57RecordReader::kRange);
  resize_large(node_, count);
  if (columns.return_index) return_.resize(count);
  if (!choose_frame(declared(scan.rows, field(*columns.row)), declared(scan.columns, field(*columns.column))))
    row_ = column_ = {};
}

ScanGrid::Bounds ScanGrid::declared(const std::optional<E57Limits>& bounds, const E57Field& field) {
  constexpr double kLargest = 1e9;  // of a grid anyone scanned
  if (bounds && std::abs(bounds->minimum) < kLargest && std::abs(bounds->maximum) < kLargest)
    return {static_cast<std::int64_t>(bounds->minimum), static_cast<std::int64_t>(bounds->maximum)};
  return {field.minimum, field.maximum};
}

bool ScanGrid::choose_frame(Bounds row, Bounds column) {
  row_ = row;
  column_ = column;
  return grid_nodes(row.extent(), column.extent()) > 0;
}

void ScanGrid::add(const E57Records& records) {
  if (!usable_) return;
  Range& range = ranges_[records.first / E57RecordReader::kRange];
  range = {};
  const auto rows = records.integers[*columns_.row], columns = records.integers[*columns_.column];
  const std::uint64_t across = column_.extent();
  LostRecords lost(records.lost);
  bool first = true;
  for (std::size_t i = 0; i < records.count; ++i) {
    const std::uint64_t record = records.first + i;
    std::uint32_t& node = node_[record];
    if (lost.has(record)) {
      node = Scan::kNoNode;
      continue;
    }
    const std::int64_t row = rows[i], column = columns[i];
    if (first) {
      range.row = {row, row};
      range.column = {column, column};
      first = false;
    }
    range.row = {std::min(range.row.low, row), std::max(range.row.high, row)};
    range.column = {std::min(range.column.low, column), std::max(range.column.high, column)};
    const bool inside =
        row >= row_.low && row <= row_.high && column >= column_.low && column <= column_.high;
    range.outside |= !inside;
    node = inside ? static_cast<std::uint32_t>(static_cast<std::uint64_t>(row - row_.low) * across +
                                               static_cast<std::uint64_t>(column - column_.low))
                  : Scan::kNoNode;
  }
  if (!columns_.return_index) return;
  const std::size_t slot = *columns_.return_index;
  for (std::size_t i = 0; i < records.count; ++i) {
    const double index = records.integers[slot].empty() ? records.reals[slot][i]
                                                        : static_cast<double>(records.integers[slot][i]);
    const std::uint8_t kept = kept_return(index);
    return_[records.first + i] = kept;
    range.several |= kept > 0;
  }
}

bool ScanGrid::outside() const {
  return std::ranges::any_of(ranges_, [](const Range& range) { return range.outside; });
}

void ScanGrid::restart() {
  Bounds row, column;
  for (const Range& range : ranges_) {
    if (range.row.high < range.row.low) continue;  // all lost
    const bool first = row.high < row.low;
    row = {first ? range.row.low : std::min(row.low, range.row.low),
           first ? range.row.high : std::max(row.high, range.row.high)};
    column = {first ? range.column.low : std::min(column.low, range.column.low),
              first ? range.column.high : std::max(column.high, range.column.high)};
  }
  usable_ = choose_frame(row, column);
}

bool ScanGrid::in_order(const Scan& scan, bool row_by_row) const {
  const std::size_t rows = static_cast<std::size_t>(scan.grid_rows),
                    cols = static_cast<std::size_t>(scan.grid_cols);
  std::atomic<bool> same{true};
  parallel_for(ranges_.size(), [&](std::size_t r) {
    const std::size_t begin = r * E57RecordReader::kRange;
    const std::size_t end = std::min(begin + E57RecordReader::kRange, node_.size());
    for (std::size_t i = begin; i < end && same; ++i)
      if (node_[i] != (row_by_row ? i : i % rows * cols + i / rows)) same = false;
  });
  return same;
}

void ScanGrid::keep_first_returns(const Scan& scan, std::uint64_t nodes) {
  std::vector<std::uint8_t> first(nodes, 255);
  for (std::size_t i = 0; i < node_.size(); ++i)
    if (node_[i] != Scan::kNoNode && std::isfinite(scan.points[i][0]))
      first[node_[i]] = std::min(first[node_[i]], return_[i]);
  for (std::size_t i = 0; i < node_.size(); ++i)
    if (node_[i] != Scan::kNoNode && return_[i] > first[node_[i]]) node_[i] = Scan::kNoNode;
}

void ScanGrid::finish(Scan& scan) {
  if (columns_.row && !usable_ && !scan.points.empty()) scan.notes.emplace_back(kNoGrid);
  if (!usable_) return;
  const Bounds old_row = row_, old_column = column_;
  restart();  // the smallest rectangle; it lies within the frame
  const std::uint64_t rows = row_.extent(), columns = column_.extent();
  if (!usable_ || rows < 2 || columns < 2) return;
  const std::uint64_t nodes = grid_nodes(rows, columns);
  if (const std::string note = too_sparse(rows, columns, node_.size()); !note.empty()) {
    scan.notes.push_back(note);
    return;
  }
  const auto row_off = static_cast<std::uint64_t>(row_.low - old_row.low);
  const auto column_off = static_cast<std::uint64_t>(column_.low - old_column.low);
  const std::uint64_t across = old_column.extent();
  parallel_for(ranges_.size(), [&](std::size_t r) {
    const std::size_t begin = r * E57RecordReader::kRange;
    const std::size_t end = std::min(begin + E57RecordReader::kRange, node_.size());
    for (std::size_t i = begin; i < end; ++i)
      if (node_[i] != Scan::kNoNode)
        node_[i] = static_cast<std::uint32_t>((node_[i] / across - row_off) * columns + node_[i] % across -
                                              column_off);
  });
  scan.grid_rows = static_cast<int>(rows);
  scan.grid_cols = static_cast<int>(columns);
  if (std::ranges::any_of(ranges_, [](const Range& range) { return range.several; }))
    keep_first_returns(scan, nodes);
  if (nodes == node_.size() && in_order(scan, false)) return;
  if (nodes == node_.size() && in_order(scan, true)) {
    scan.row_by_row = true;
    return;
  }
  scan.node = std::move(node_);
}

}  // namespace hybrid::io
