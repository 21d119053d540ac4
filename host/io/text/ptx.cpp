#include "io/text/ptx.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/input_file.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text/text_cursor.hpp"
#include "io/text/text_samples.hpp"
#include "io/text/text_stream.hpp"

namespace hybrid::io {
namespace {

constexpr double kSamePlace_m = 0.001;

constexpr std::uint64_t kShortestXyzi = 8;  // "0 0 0 0\n"

struct PtxHeader {
  std::uint64_t line = 0;  // of its first line
  std::uint64_t cols = 0, rows = 0;
  std::array<double, 16> world_from_scan{};  // row-major, column vectors
  Vec3 position = Vec3::Zero();              // of the scanner, as its line says
};

[[noreturn]] void fail_cut_short(const TextCursor& cursor, const std::string& expected) {
  fail_input(
      "{}: line {}: expected {}, found the end of the file; the file is cut short: copy or export it again, "
      "{}",
      cursor.file(), cursor.line(), expected, kSalvageRemedy);
}

// The next line's numbers, which must fill `values`.
void read_line(TextCursor& cursor, std::span<double> values, const char* meaning) {
  cursor.skip_blank_lines();
  const std::uint64_t line = cursor.line();
  if (cursor.at_end()) fail_cut_short(cursor, meaning);
  cursor.refuse_decimal_commas();
  const std::size_t found = cursor.read_numbers(values);
  if (found != values.size())
    fail_input(
        "{}: line {}: expected {} ({} numbers), found {}; is this a PTX file, and do the columns and rows of "
        "its header match its points? Correct it, {}",
        cursor.file(), line, meaning, values.size(), found, kSalvageRemedy);
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

// Columns, rows, the scanner's position and axes (the same pose again, used for nothing but a comparison),
// and the 4x4, which multiplies row vectors from the right and so has the translation in its last row.
PtxHeader read_header(TextCursor& cursor) {
  PtxHeader header{cursor.line()};
  header.cols = read_count(cursor, "the number of columns, a whole number from 1");
  header.rows = read_count(cursor, "the number of rows, a whole number from 1");
  std::array<double, 4> row{};
  for (int i = 0; i < 4; ++i) {
    read_line(cursor, std::span(row).first(3), "the scanner's position and axes");
    if (i == 0) header.position = {row[0], row[1], row[2]};
  }
  for (std::size_t i = 0; i < 4; ++i) {
    read_line(cursor, row, "a row of the 4x4 matrix");
    for (std::size_t j = 0; j < 4; ++j) header.world_from_scan[4 * j + i] = row[j];
  }
  return header;
}

// Files whose points are in world coordinates have a position beside the identity: the beams begin there.
void compare_position(Scan& scan, const std::string& file, const PtxHeader& header) {
  const Vec3& p = header.position;
  if (p.norm() <= kSamePlace_m || header.world_from_scan != row_major(Pose{})) return;
  scan.notes.push_back(
      fmt::format("line {}: the scanner's position {} {} {} does not fit the matrix, the identity, which is "
                  "used; if the points are in world coordinates, give the scan `scanner = [{}, {}, {}]`",
                  header.line + 2, p.x(), p.y(), p.z(), p.x(), p.y(), p.z()));
  log::warning("{}: {}", file, scan.notes.back());
}

void set_pose(Scan& scan, const std::string& file, const PtxHeader& header, bool salvage) {
  compare_position(scan, file, header);
  if (header.world_from_scan == row_major(Pose{})) return;
  try {
    scan.world_from_scan = pose_from_row_major(header.world_from_scan);
  } catch (const Error& error) {
    const auto problem = fmt::format(
        "lines {} to {} (the scan's 4x4 matrix, transposed: the translation "
        "stands in the last): {}",
        header.line + 6, header.line + 9, error.what());
    if (!salvage)
      fail_input("{}: {}; correct it, or write the identity and register the scan, {}", file, problem,
                 kSalvageRemedy);
    scan.notes.push_back(problem + ": the pose is left out");
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
                   kShortestXyzi, cursor.remaining() + 1, true);
  return header;
}

// How many numbers the line has that the cursor reads; 0 for one that holds something else, or is too long.
std::size_t numbers_in(TextCursor& cursor, double& first) {
  try {
    return cursor.at_end() ? 0 : cursor.try_numbers({&first, 1}).value_or(0);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    return 0;
  }
}

// How many numbers the first point has, without moving past it.
std::size_t count_columns(InputFile& input, const TextCursor& before, const PtxHeader& header) {
  TextCursor cursor(input, before.offset(), before.line());
  std::array<double, 7> values{};
  cursor.skip_blank_lines();
  if (cursor.at_end()) fail_points_missing(cursor, header, 0);
  const std::uint64_t line = cursor.line();
  cursor.refuse_decimal_commas();
  const std::size_t columns = cursor.read_numbers(values);
  if (columns != 4 && columns != 7)
    fail_input("{}: line {}: expected 4 or 7 numbers (x y z intensity [red green blue]), found {}",
               cursor.file(), line, columns);
  return columns;
}

// The same in salvage, of the first point that is one.
std::size_t count_most_columns(InputFile& input, const TextCursor& before, std::uint64_t lines) {
  TextCursor cursor(input, before.offset(), before.line());
  for (double value = 0; lines > 0; --lines) {
    cursor.skip_blank_lines();
    const TextPlace line{cursor.offset(), cursor.line()};
    const std::size_t columns = numbers_in(cursor, value);
    if (columns == 4 || columns == 7) return columns;
    cursor.move_to(line.offset, line.line);
    cursor.next_line();
  }
  fail_input("{}: line {}: expected points of 4 or 7 numbers, found none; export the file again",
             cursor.file(), before.line());
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

void read_point(TextCursor& cursor, std::span<double> values, const PtxHeader& header, std::uint64_t done) {
  if (cursor.at_end()) fail_points_missing(cursor, header, done);
  read_line(cursor, values, values.size() == 7 ? "x y z intensity red green blue" : "x y z intensity");
}

// Where a scan starts in a damaged file: two counts and the scanner's position.
bool starts_scan(InputFile& input, const TextPlace& place) {
  TextCursor cursor(input, place.offset, place.line);
  double value = 0;
  for (int i = 0; i < 2; ++i) {
    if (numbers_in(cursor, value) != 1 || !(value >= 1) || value != std::floor(value)) return false;
    cursor.skip_blank_lines();
  }
  return numbers_in(cursor, value) == 3;
}

// Behind the line at `place` and the blank ones after it.
TextPlace behind_line(InputFile& input, const TextPlace& place) {
  TextCursor cursor(input, place.offset, place.line);
  cursor.next_line();
  cursor.skip_blank_lines();
  return {cursor.offset(), cursor.line()};
}

// The scan that starts at `place`: of its points those that stand before the next scan. `place` moves there.
ScanEntry salvage_one(InputFile& input, TextPlace& place) {
  ScanEntry entry{.structure = std::string("x y z intensity"), .offset = place.offset, .line = place.line};
  entry.unit = std::string("m");
  try {
    TextCursor cursor(input, place.offset, place.line);
    const PtxHeader header = read_header(cursor);
    cursor.skip_blank_lines();
    place = {cursor.offset(), cursor.line()};
    while (place.offset < input.size() && entry.samples < point_count(header) && !starts_scan(input, place)) {
      place = behind_line(input, place);
      ++entry.samples;
    }
    if (entry.samples == 0) {
      TextCursor end(input, place.offset, place.line);
      fail_points_missing(end, header, 0);
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    entry.problem = error.what();
    if (place.offset == entry.offset) place = behind_line(input, place);
  }
  entry.end = place.offset;
  return entry;
}

// What stands between scans, or is one whose header makes no sense.
ScanEntry pass_no_scan(InputFile& input, TextPlace& place) {
  ScanEntry entry{.offset = place.offset, .line = place.line};
  while (place.offset < input.size() && !starts_scan(input, place)) place = behind_line(input, place);
  entry.end = place.offset;
  const std::uint64_t bytes = entry.end - entry.offset;
  entry.problem = fmt::format(
      "{}: line {}: expected a scan's columns, rows and position, found something else: {} bytes ({:.2f} % "
      "of "
      "the file) from byte {} on are lost; export the file again",
      input.name(), entry.line, bytes, 100 * static_cast<double>(bytes) / static_cast<double>(input.size()),
      entry.offset);
  return entry;
}

std::vector<ScanEntry> list_damaged_ptx(InputFile& input) {
  std::vector<ScanEntry> entries;
  TextCursor cursor(input, start_of_text(input));
  cursor.skip_blank_lines();
  TextPlace place{cursor.offset(), cursor.line()};
  while (place.offset < input.size())
    entries.push_back(starts_scan(input, place) ? salvage_one(input, place) : pass_no_scan(input, place));
  const auto good = [](const ScanEntry& entry) { return entry.problem.empty(); };
  if (std::none_of(entries.begin(), entries.end(), good)) {
    if (!entries.empty()) throw Error(ErrorKind::input, entries.front().problem);
    TextCursor end(input, input.size());
    fail_cut_short(end, "the number of columns, a whole number from 1");
  }
  return entries;
}

void name_entries(std::vector<ScanEntry>& entries, const std::string& stem) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].index = i;
    entries[i].name = entries.size() == 1 ? stem : fmt::format("{}-{}", stem, i);
  }
}

class PtxStream : public TextStream {
 public:
  PtxStream(const std::filesystem::path& file, const ScanEntry& entry) : TextStream(file, entry) {
    TextCursor cursor(input(), entry.offset, entry.line);
    header_ = read_checked_header(cursor);
    head_.grid_cols = static_cast<int>(header_.cols);
    head_.grid_rows = static_cast<int>(header_.rows);
    columns_ = {count_columns(input(), cursor, header_)};
    add_notes(take({.start = {cursor.offset(), cursor.line()},
                    .count = point_count(header_),
                    .columns = columns_.count,
                    .intensity = columns_.intensity(),
                    .colour = columns_.colour() ? ColourKind::byte : ColourKind::none,
                    .zero_is_no_return = true}));
    if (facts().least >= 0 && facts().greatest <= 1) head_.intensity_limits = {0.0f, 1.0f};
    set_pose(head_, cursor.file(), header_, false);
  }

 private:
  ScanSample sample(const double* row) const override { return columns_.sample(row); }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const override {
    read_point(cursor, values, header_, done);
  }
  PtxHeader header_;
  TextColumns columns_;
};

}  // namespace

std::vector<ScanEntry> list_ptx(const std::filesystem::path& file, const ReadOptions& options) {
  InputFile input(file);
  if (options.salvage) {
    std::vector<ScanEntry> entries = list_damaged_ptx(input);
    name_entries(entries, file.stem().string());
    return entries;
  }
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
  name_entries(entries, file.stem().string());
  return entries;
}

Scan read_ptx(const std::filesystem::path& file, const ScanEntry& entry) {
  InputFile input(file);
  TextCursor cursor(input, entry.offset, entry.line);
  const PtxHeader header = entry.salvage ? read_header(cursor) : read_checked_header(cursor);
  const std::size_t columns =
      entry.salvage ? count_most_columns(input, cursor, entry.samples) : count_columns(input, cursor, header);
  const std::uint64_t count = entry.salvage ? entry.samples : point_count(header);
  Damage damage(cursor.file());
  ScanBuilder builder(cursor.file(), entry.name, count,
                      {.intensity = true,
                       .colour = columns == 7 ? ColourKind::byte : ColourKind::none,
                       .zero_is_no_return = true,
                       .salvage = entry.salvage,
                       .exact = entry.exact});
  bool commas = false;
  add_text_samples(
      input, {cursor.offset(), cursor.line()}, count, columns, builder, commas,
      [&](const double* row) { return TextColumns{columns}.sample(row); },
      [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
        read_point(at, values, header, done);
      },
      entry.salvage ? &damage : nullptr);
  const CroppedGrid grid = cropped_grid(header.rows, builder.size());
  if (builder.size() < point_count(header)) {
    damage.add(point_count(header) - builder.size(),
               fmt::format("byte {}: the points that line {} announces end", entry.end, entry.line));
    builder.add_lost(grid.nodes() - std::min<std::uint64_t>(grid.nodes(), builder.size()));
  }
  if (damage.records() > 0) builder.add_note(damage.note(point_count(header)));
  Scan scan = builder.finish();
  if (within(scan.intensity, 0, 1)) scan.intensity_limits = {0.0f, 1.0f};
  scan.grid_cols = static_cast<int>(grid.slow);
  scan.grid_rows = static_cast<int>(grid.fast);
  set_pose(scan, cursor.file(), header, entry.salvage);
  return scan;
}

std::unique_ptr<ScanStream> stream_ptx(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  return std::make_unique<PtxStream>(file, entry);
}

}  // namespace hybrid::io
