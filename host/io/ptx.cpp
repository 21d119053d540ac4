#include "io/ptx.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/input_file.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"

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

Scan read_one(TextCursor& cursor, const std::string& name) {
  const PtxHeader header = read_header(cursor);
  const std::uint64_t count = header.cols * header.rows;
  cursor.skip_blank_lines();
  const std::uint64_t first_line = cursor.line();
  check_count_fits(cursor.file(), fmt::format("line {}", header.line), "points", count, kShortestLine,
                   cursor.remaining() + 1);

  std::array<double, 7> values{};
  if (cursor.at_end()) fail_points_missing(cursor, header, 0);
  const std::size_t columns = cursor.read_numbers(values);  // the first point tells
  if (columns != 4 && columns != 7)
    fail_input("{}: line {}: expected 4 or 7 numbers (x y z intensity [red green blue]), found {}",
               cursor.file(), first_line, columns);
  const bool colour = columns == 7;
  ScanBuilder builder(
      cursor.file(), name, count,
      {.intensity = true, .colour = colour ? ColourKind::byte : ColourKind::none, .zero_is_no_return = true});
  const auto line_values = std::span(values).first(columns);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i > 0) {
      cursor.skip_blank_lines();
      if (cursor.at_end()) fail_points_missing(cursor, header, i);
      read_line(cursor, line_values, colour ? "x y z intensity red green blue" : "x y z intensity");
    }
    builder.add_point(values[0], values[1], values[2]);
    builder.add_intensity(values[3]);
    if (colour) builder.add_colour(values[4], values[5], values[6]);
  }
  Scan scan = builder.finish();
  scan.grid_cols = static_cast<int>(header.cols);
  scan.grid_rows = static_cast<int>(header.rows);
  set_pose(scan, cursor.file(), header);
  return scan;
}

}  // namespace

std::vector<Scan> read_ptx(const std::filesystem::path& file) {
  InputFile input(file);
  TextCursor cursor(input, start_of_text(input));
  const std::string stem = file.stem().string();
  std::vector<Scan> scans;
  do {
    scans.push_back(read_one(cursor, fmt::format("{}-{}", stem, scans.size())));
    cursor.skip_blank_lines();
  } while (!cursor.at_end());
  if (scans.size() == 1) scans[0].name = stem;
  return scans;
}

}  // namespace hybrid::io
