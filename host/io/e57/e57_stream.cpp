#include "io/e57/e57_stream.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/error.hpp"
#include "io/e57/scan_notes.hpp"

namespace hybrid::io {
namespace {

// Of a range of records, or all.
struct Indices {
  ScanGrid::Bounds row, column;
  bool none = true, several = false, by_columns = true, by_rows = true;

  void add(std::int64_t r, std::int64_t c) {
    if (none) row = {r, r}, column = {c, c};
    none = false;
    row = {std::min(row.low, r), std::max(row.high, r)};
    column = {std::min(column.low, c), std::max(column.high, c)};
  }
  void add(const Indices& other) {
    by_columns &= other.by_columns;
    by_rows &= other.by_rows;
    if (other.none) return;
    add(other.row.low, other.column.low);
    add(other.row.high, other.column.high);
    several |= other.several;
  }
};

// `row` and `column`: the bounds by which the order is judged. In salvage a record whose point is lost has no
// place, so that all fields are read.
Indices read_indices(const ScanColumns& columns, const E57RecordReader& reader, ScanGrid::Bounds row,
                     ScanGrid::Bounds column, bool salvage) {
  std::vector<std::size_t> fields = {columns.fields[*columns.row], columns.fields[*columns.column]};
  if (columns.return_index) fields.push_back(columns.fields[*columns.return_index]);
  if (salvage)
    for (const std::size_t field : columns.fields)
      if (std::ranges::find(fields, field) == fields.end()) fields.push_back(field);
  const std::uint64_t rows = std::max<std::uint64_t>(row.extent(), 1),
                      cols = std::max<std::uint64_t>(column.extent(), 1);
  std::vector<Indices> ranges(reader.count() / E57RecordReader::kRange + 1);
  const auto take = [&](const E57Records& records) {
    Indices& range = ranges[records.first / E57RecordReader::kRange];
    LostRecords lost(records.lost);
    for (std::size_t i = 0; i < records.count; ++i) {
      if (lost.has(records.first + i)) {
        range.by_columns = range.by_rows = false;
        continue;
      }
      const std::int64_t r = records.integers[0][i], c = records.integers[1][i];
      range.add(r, c);
      const std::uint64_t record = records.first + i,
                          down = static_cast<std::uint64_t>(r) - static_cast<std::uint64_t>(row.low),
                          right = static_cast<std::uint64_t>(c) - static_cast<std::uint64_t>(column.low);
      range.by_columns &= down == record % rows && right == record / rows;
      range.by_rows &= right == record % cols && down == record / cols;
      if (columns.return_index)
        range.several |= (records.integers[2].empty() ? records.reals[2][i]
                                                      : static_cast<double>(records.integers[2][i])) > 0;
    }
  };
  for (std::uint64_t at = 0; at < reader.count(); at += ScanStream::kBlock)
    reader.read(fields, at, std::min<std::uint64_t>(ScanStream::kBlock, reader.count() - at), take);
  Indices all;
  for (const Indices& range : ranges) all.add(range);
  return all;
}

bool same(ScanGrid::Bounds a, ScanGrid::Bounds b) {
  return a.low == b.low && a.high == b.high;
}

}  // namespace

GridOutline outline_grid(const E57Scan& scan, const ScanColumns& columns, const E57RecordReader& reader,
                         bool salvage) {
  GridOutline outline;
  if (!columns.row || reader.count() == 0) return outline;
  const auto field = [&](std::size_t slot) -> const E57Field& {
    return scan.points.fields[columns.fields[slot]];
  };
  if (!field(*columns.row).is_integer() || !field(*columns.column).is_integer()) {
    outline.note = kNoGrid;
    return outline;
  }
  outline.row = ScanGrid::declared(scan.rows, field(*columns.row));
  outline.column = ScanGrid::declared(scan.columns, field(*columns.column));
  Indices found = read_indices(columns, reader, outline.row, outline.column, salvage);
  if (!same(found.row, outline.row) || !same(found.column, outline.column))
    found = read_indices(columns, reader, found.row, found.column, salvage);
  if (found.none) return outline;  // all are lost
  outline.row = found.row;
  outline.column = found.column;
  outline.several_returns = found.several;
  const std::uint64_t rows = found.row.extent(), cols = found.column.extent(), nodes = grid_nodes(rows, cols);
  if (nodes == 0)
    outline.note = kNoGrid;
  else if (rows > 1 && cols > 1)
    outline.note = too_sparse(rows, cols, reader.count());
  outline.grid = nodes > 0 && rows > 1 && cols > 1 && outline.note.empty();
  outline.column_by_column = nodes == reader.count() && found.by_columns;
  outline.row_by_row = nodes == reader.count() && found.by_rows && !found.by_columns;
  return outline;
}

E57Stream::E57Stream(const std::string& file, const E57Scan& source, std::unique_ptr<E57RecordReader> reader,
                     bool salvage)
    : source_(source),
      where_(file + ": " + source.points.what),
      reader_(std::move(reader)),
      samples_(where_, source, *reader_),
      salvage_(salvage) {}

std::unique_ptr<ScanStream> E57Stream::open(const std::string& file, const E57Contents& contents,
                                            std::size_t index, std::unique_ptr<E57RecordReader> reader,
                                            const ScanEntry& entry, std::shared_ptr<const void> owner) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (reader->count() > kMost)
    fail_input("{}: {}: expected at most {} points, found {}; split the file", file,
               contents.scans.at(index).points.what, kMost, reader->count());
  std::unique_ptr<E57Stream> stream(
      new E57Stream(file, contents.scans.at(index), std::move(reader), entry.salvage));
  stream->owner_ = std::move(owner);
  const GridOutline grid =
      outline_grid(stream->source_, stream->samples_.columns(), *stream->reader_, entry.salvage);
  stream->take(grid, entry);
  name_e57_scan(file, contents, index, stream->head_);
  return stream;
}

std::unique_ptr<ScanStream> E57Stream::open(const std::filesystem::path& file, const ScanEntry& entry) {
  const auto opened = std::make_shared<const E57File>(file, E57Options{.salvage = entry.salvage});
  const std::vector<E57Scan>& scans = opened->contents().scans;
  if (entry.index >= scans.size())
    fail_input("{}: expected scan {}, found {} scans; choose one of them", opened->name(), entry.index,
               scans.size());
  auto stream =
      open(opened->name(), opened->contents(), entry.index,
           std::make_unique<E57TableReader>(opened->pages(), scans[entry.index].points), entry, opened);
  auto& notes = static_cast<E57Stream&>(*stream).head_.notes;
  notes.insert(notes.end(), opened->notes().begin(), opened->notes().end());
  return stream;
}

void E57Stream::take(const GridOutline& grid, const ScanEntry& entry) {
  const ScanColumns& columns = samples_.columns();
  count_ = reader_->count();
  exact_ = entry.exact && samples_.rounds();
  intensity_ = columns.intensity.has_value();
  colour_ = columns.colour.has_value();
  describe_e57_scan(source_, samples_, *reader_, head_);
  if (grid.grid) {
    head_.grid_rows = static_cast<int>(grid.row.extent());
    head_.grid_cols = static_cast<int>(grid.column.extent());
    head_.row_by_row = grid.row_by_row;
    node_ = !grid.row_by_row && !grid.column_by_column;
    row_ = grid.row;
    column_ = grid.column;
    if (grid.several_returns) find_first_returns();
  }
  measuring_ = true;
  measure(entry.kept_bytes);
  measuring_ = false;
  note_tallies(where_, sum_of(tallies_), *reader_, salvage_, head_);
  tallies_.clear();
  if (exact_) head_.steps = samples_.steps();
  if (!grid.note.empty()) head_.notes.push_back(grid.note);
  add_e57_notes(source_, columns, count_, head_);
}

std::uint32_t E57Stream::node_of(const E57Records& records, std::size_t i) const {
  const ScanColumns& columns = samples_.columns();
  const auto from = [&](std::size_t slot, std::int64_t low) {
    return static_cast<std::uint64_t>(records.integers[slot][i]) - static_cast<std::uint64_t>(low);
  };
  const std::uint64_t row = from(*columns.row, row_.low), column = from(*columns.column, column_.low);
  if (row >= row_.extent() || column >= column_.extent())
    fail_input(
        "{}: record {}: expected the row and column indices of the pass before, found others; the file was "
        "changed meanwhile: read it again",
        where_, records.first + i);
  return static_cast<std::uint32_t>(row * column_.extent() + column);
}

std::uint8_t E57Stream::return_of(const E57Records& records, std::size_t i) const {
  const std::size_t slot = *samples_.columns().return_index;
  return ScanGrid::kept_return(records.integers[slot].empty()
                                   ? records.reals[slot][i]
                                   : static_cast<double>(records.integers[slot][i]));
}

void E57Stream::find_first_returns() {
  first_return_.assign(grid_nodes(row_.extent(), column_.extent()), 255);
  reader_->read(samples_.columns().fields, 0, count_, [&](const E57Records& records) {
    std::array<std::array<float, 3>, E57RecordReader::kRange> points;
    SampleTally ignored;
    samples_.points(records, std::span(points).first(records.count), ignored);
    LostRecords lost(records.lost);
    for (std::size_t i = 0; i < records.count; ++i) {
      if (!std::isfinite(points[i][0]) || lost.has(records.first + i)) continue;
      const std::uint8_t found = return_of(records, i);
      const std::atomic_ref<std::uint8_t> first(first_return_[node_of(records, i)]);
      std::uint8_t held = first.load(std::memory_order_relaxed);
      while (found < held && !first.compare_exchange_weak(held, found, std::memory_order_relaxed)) {
      }
    }
  });
}

SampleBlock E57Stream::load(std::uint64_t first, std::size_t count) const {
  const ScanColumns& columns = samples_.columns();
  block_.points.resize(count);
  block_.exact.resize(exact_ ? count : 0);
  block_.intensity.resize(intensity_ ? count : 0);
  block_.rgb.resize(colour_ ? count : 0);
  block_.node.resize(node_ ? count : 0);
  std::vector<SampleTally> tallies(count / E57RecordReader::kRange + 1);
  reader_->read(columns.fields, first, count, [&](const E57Records& records) {
    const std::size_t at = static_cast<std::size_t>(records.first - first);
    const auto part = [&](auto& values) {
      return std::span(values).subspan(values.empty() ? 0 : at, values.empty() ? 0 : records.count);
    };
    SampleTally& tally = tallies[at / E57RecordReader::kRange];
    samples_.points(records, part(block_.points), tally, part(block_.exact));
    if (intensity_) samples_.intensities(records, part(block_.intensity));
    if (colour_) samples_.colours(records, part(block_.rgb));
    if (!node_ && records.lost.empty()) return;
    LostRecords lost(records.lost);
    for (std::size_t i = 0; i < records.count; ++i) {
      if (lost.has(records.first + i)) {
        ++tally.lost;
        block_.points[at + i] = {NAN, NAN, NAN};
        if (node_) block_.node[at + i] = Scan::kNoNode;
        continue;
      }
      if (!node_) continue;
      const std::uint32_t node = node_of(records, i);
      const bool has_it = first_return_.empty() || return_of(records, i) <= first_return_[node];
      block_.node[at + i] = has_it ? node : Scan::kNoNode;
    }
  });
  if (measuring_) tallies_.push_back(sum_of(tallies));
  return block_.block(head_, first, 0, count);
}

}  // namespace hybrid::io
