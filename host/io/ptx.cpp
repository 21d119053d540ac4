#include "io/ptx.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/input_file.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"
#include "io/text_samples.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kShortestLine = 8;  // "0 0 0 0\n"

struct PtxHeader {
  std::uint64_t line = 0;  // of its first line
  std::uint64_t cols = 0, rows = 0;
  std::array<double, 16> world_from_scan{};  // row-major, column vectors
};

[[noreturn]] void fail_cut_short(const TextCursor& cursor, const std::string& expected) {
  fail_input(
      "{}: line {}: expected {}, found the end of the file; the file is cut short: copy or export it again",
      cursor.file(), cursor.line(), expected);
}

// The next line's numbers, which must fill `values`.
void read_line(TextCursor& cursor, std::span<double> values, const char* meaning) {
  cursor.skip_blank_lines();
  const std::uint64_t line = cursor.line();
  if (cursor.at_end()) fail_cut_short(cursor, meaning);
  const std::size_t found = cursor.read_numbers(values);
  if (found != values.size())
    fail_input(
        "{}: line {}: expected {} ({} numbers), found {}; is this a PTX file, and do the columns and rows of "
        "its header match its points?",
        cursor.file(), line, meaning, values.size(), found);
}

std::uint64_t read_count(TextCursor& cursor, const char* meaning) {
  cursor.skip_blank_lines();
  const std::uint64_t line = cursor.line();
  double value = 0;
  read_line(cursor, {&value, 1}, meaning);
  if (!(value >= 1 && value <= std::numeric_limits<std::int32_t>::max()) || value != std::floor(value))
    fail_input("{}: line {}: expected {}, found {}; is this a PTX file?", cursor.file(), line, meaning,
               value);
  return static_cast<std::uint64_t>(value);
}

// Columns, rows, the scanner's position and axes (the same pose again, not used), and the 4x4, which
// multiplies row vectors from the right and so has the translation in its last row.
PtxHeader read_header(TextCursor& cursor) {
  PtxHeader header{cursor.line()};
  header.cols = read_count(cursor, "the number of columns, a whole number from 1");
  header.rows = read_count(cursor, "the number of rows, a whole number from 1");
  std::array<double, 4> row{};
  for (int i = 0; i < 4; ++i) read_line(cursor, std::span(row).first(3), "the scanner's position and axes");
  for (std::size_t i = 0; i < 4; ++i) {
    read_line(cursor, row, "a row of the 4x4 matrix");
    for (std::size_t j = 0; j < 4; ++j) header.world_from_scan[4 * j + i] = row[j];
  }
  return header;
}

void set_pose(Scan& scan, const std::string& file, const PtxHeader& header) {
  if (header.world_from_scan == row_major(Pose{})) return;
  try {
    scan.world_from_scan = pose_from_row_major(header.world_from_scan);
  } catch (const Error& error) {
    fail_input(
        "{}: lines {} to {} (the scan's 4x4 matrix): {}; correct it, or write the identity and register the "
        "scan",
        file, header.line + 6, header.line + 9, error.what());
  }
}

[[noreturn]] void fail_points_missing(const TextCursor& cursor, const PtxHeader& header,
                                      std::uint64_t found) {
  fail_cut_short(cursor, fmt::format("{} points ({} columns of {} rows), of which {} are here",
                                     header.cols * header.rows, header.cols, header.rows, found));
}

std::uint64_t point_count(const PtxHeader& header) {
  return header.cols * header.rows;
}

// The header at the cursor, whose points the rest of the file can hold.
PtxHeader read_checked_header(TextCursor& cursor) {
  const PtxHeader header = read_header(cursor);
  check_count_fits(cursor.file(), fmt::format("line {}", header.line), "points", point_count(header),
                   kShortestLine, cursor.remaining() + 1);
  return header;
}

// How many numbers the first point has, without moving past it.
std::size_t count_columns(InputFile& input, const TextCursor& before, const PtxHeader& header) {
  TextCursor cursor(input, before.offset(), before.line());
  std::array<double, 7> values{};
  cursor.skip_blank_lines();
  if (cursor.at_end()) fail_points_missing(cursor, header, 0);
  const std::uint64_t line = cursor.line();
  const std::size_t columns = cursor.read_numbers(values);
  if (columns != 4 && columns != 7)
    fail_input("{}: line {}: expected 4 or 7 numbers (x y z intensity [red green blue]), found {}",
               cursor.file(), line, columns);
  return columns;
}

// The entry of the scan at `place`, which moves behind it.
ScanEntry list_one(InputFile& input, TextPlace& place) {
  ScanEntry entry{.offset = place.offset, .line = place.line};
  TextCursor cursor(input, place.offset, place.line);
  const PtxHeader header = read_checked_header(cursor);
  entry.samples = point_count(header);
  entry.grid_cols = static_cast<int>(header.cols);
  entry.grid_rows = static_cast<int>(header.rows);
  try {
    const bool colour = count_columns(input, cursor, header) == 7;
    entry.structure = colour ? "x y z intensity red green blue" : "x y z intensity";
  } catch (const Error& error) {  // a damaged sample, which leaves the scans behind it
    if (error.kind() != ErrorKind::input) throw;
    entry.problem = error.what();
  }
  entry.unit = std::string("m");
  const PassedRows points = pass_rows(input, {cursor.offset(), cursor.line()}, input.size(), entry.samples);
  if (points.rows < entry.samples) {
    TextCursor end(input, points.after.offset, points.after.line);
    fail_points_missing(end, header, points.rows);
  }
  place = points.after;
  entry.end = place.offset;
  return entry;
}

}  // namespace

std::vector<ScanEntry> list_ptx(const std::filesystem::path& file) {
  InputFile input(file);
  TextPlace place{start_of_text(input)};
  std::vector<ScanEntry> entries;
  for (bool more = true; more;) {
    const TextPlace start = place;
    try {
      entries.push_back(list_one(input, place));
    } catch (const Error& error) {
      if (entries.empty() || error.kind() != ErrorKind::input) throw;
      entries.push_back({.problem = error.what(), .offset = start.offset, .line = start.line});
      break;
    }
    TextCursor cursor(input, place.offset, place.line);
    cursor.skip_blank_lines();
    place = {cursor.offset(), cursor.line()};
    more = !cursor.at_end();
  }
  const std::string stem = file.stem().string();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].index = i;
    entries[i].name = entries.size() == 1 ? stem : fmt::format("{}-{}", stem, i);
  }
  return entries;
}

Scan read_ptx(const std::filesystem::path& file, const ScanEntry& entry) {
  InputFile input(file);
  TextCursor cursor(input, entry.offset, entry.line);
  const PtxHeader header = read_checked_header(cursor);
  const std::size_t columns = count_columns(input, cursor, header);
  ScanBuilder builder(cursor.file(), entry.name, point_count(header),
                      {.intensity = true,
                       .colour = columns == 7 ? ColourKind::byte : ColourKind::none,
                       .zero_is_no_return = true});
  const bool colour = columns == 7;
  bool commas = false;
  add_text_samples(
      input, {cursor.offset(), cursor.line()}, point_count(header), columns, builder, commas,
      [&](const double* row) {
        ScanSample sample{row[0], row[1], row[2], row[3], {}};
        if (colour) sample.rgb = {row[4], row[5], row[6]};
        return sample;
      },
      [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
        if (at.at_end()) fail_points_missing(at, header, done);
        read_line(at, values, colour ? "x y z intensity red green blue" : "x y z intensity");
      });
  Scan scan = builder.finish();
  if (within(scan.intensity, 0, 1)) scan.intensity_limits = {0.0f, 1.0f};
  scan.grid_cols = static_cast<int>(header.cols);
  scan.grid_rows = static_cast<int>(header.rows);
  set_pose(scan, cursor.file(), header);
  return scan;
}

}  // namespace hybrid::io
