#include "io/text/pts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/input_file.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text/text_cursor.hpp"
#include "io/text/text_samples.hpp"
#include "io/text/text_stream.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kShortestXyz = 6;  // "0 0 0\n"
constexpr std::size_t kMostColumns = 7;
constexpr float kLeastIntensity = -2048, kGreatestIntensity = 2047;
constexpr const char* kCommas =
    "values are separated by commas or semicolons, which PTS does not provide for";
constexpr double kMostCounted = 9e15;  // whole numbers are exact below
constexpr const char* kColumns[] = {
    "", "", "", "x y z", "x y z intensity", "", "x y z red green blue", "x y z intensity red green blue"};

struct PointLine {
  TextPlace place;  // where it starts
  std::array<double, kMostColumns> values{};
  std::size_t numbers = 0;  // 0 too where it holds commas alone
  bool end = false;         // nothing follows any more
};

// The next line that holds something.
PointLine read_line(TextCursor& cursor) {
  cursor.skip_blank_lines();
  PointLine line{{cursor.offset(), cursor.line()}};
  line.end = cursor.at_end();
  if (line.end) return line;
  cursor.refuse_decimal_commas();
  line.numbers = cursor.read_numbers(line.values);
  return line;
}

std::uint64_t to_count(const std::string& file, const PointLine& line) {
  const double value = line.values[0];
  if (!(value >= 0 && value < std::numeric_limits<std::uint32_t>::max()) || value != std::floor(value))
    fail_input("{}: line {}: expected the number of points that follow, found {}; is this a PTS file?", file,
               line.place.line, value);
  return static_cast<std::uint64_t>(value);
}

std::size_t check_columns(const std::string& file, const PointLine& line) {
  if (line.numbers <= kMostColumns && kColumns[line.numbers][0] != '\0') return line.numbers;
  fail_input(
      "{}: line {}: expected 3, 4, 6 or 7 numbers (x y z [intensity] [red green blue]), found {}; is this a "
      "PTS file?",
      file, line.place.line, line.numbers);
}

[[noreturn]] void fail_points_missing(const std::string& file, std::uint64_t line, std::uint64_t expected,
                                      std::uint64_t count_line, std::uint64_t found) {
  fail_input(
      "{}: line {}: expected {} points as line {} says, found {} and the end of the file; it is cut short, "
      "or "
      "the count wrong: copy or export it again, or correct the count, or use --salvage",
      file, line, expected, count_line, found);
}

// Points without a count: all lines to the end.
ScanEntry list_all(InputFile& input, const PointLine& first) {
  ScanEntry entry{.structure = kColumns[check_columns(input.name(), first)]};
  const PassedRows points = pass_rows(input, first.place, input.size(), ~std::uint64_t{0});
  entry.samples = points.rows;
  entry.offset = first.place.offset;
  entry.line = first.place.line;
  return entry;
}

// The points after the line of a count, which the cursor has read; `place` goes behind them.
ScanEntry list_counted(InputFile& input, TextCursor& cursor, const PointLine& count_line, TextPlace& place) {
  ScanEntry entry;
  entry.samples = to_count(input.name(), count_line);
  check_count_fits(input.name(), fmt::format("line {}", count_line.place.line), "points", entry.samples,
                   kShortestXyz, cursor.remaining() + 1, true);
  cursor.skip_blank_lines();
  place = {cursor.offset(), cursor.line()};
  entry.offset = place.offset;
  entry.line = place.line;
  if (entry.samples == 0) return entry;
  const PointLine first = read_line(cursor);
  if (first.end) fail_points_missing(input.name(), first.place.line, entry.samples, count_line.place.line, 0);
  entry.structure = kColumns[check_columns(input.name(), first)];
  const PassedRows points = pass_rows(input, place, input.size(), entry.samples);
  if (points.rows < entry.samples)
    fail_points_missing(input.name(), points.after.line, entry.samples, count_line.place.line, points.rows);
  place = points.after;
  return entry;
}

// A scan takes two bytes ("0" and a line end), what is kept of it hundreds.
void check_scans(const InputFile& input, std::size_t scans, std::uint64_t line) {
  constexpr std::size_t kMostScans = 100'000;
  if (scans > kMostScans)
    fail_input("{}: line {}: expected at most {} counts of points, found more; is this a PTS file?",
               input.name(), line, kMostScans);
}

// The scans from the count in `line` on, one after the other.
std::vector<ScanEntry> list_all_counted(InputFile& input, TextCursor& cursor, PointLine line) {
  std::vector<ScanEntry> entries;
  TextPlace place;
  for (std::uint64_t count_line = 0; !line.end; line = read_line(cursor)) {
    try {
      if (line.numbers != 1)
        fail_input(
            "{}: line {}: expected the end of the file or another count after the points that line {} "
            "counts, "
            "found {} numbers; correct the count, or use --salvage",
            input.name(), line.place.line, count_line, line.numbers);
      count_line = line.place.line;
      check_scans(input, entries.size() + 1, count_line);
      entries.push_back(list_counted(input, cursor, line, place));
      entries.back().end = place.offset;
      cursor.move_to(place.offset, place.line);
    } catch (const Error& error) {
      if (entries.empty() || error.kind() != ErrorKind::input) throw;
      entries.push_back({.problem = error.what()});
      break;
    }
  }
  return entries;
}

// The number of numbers on the next line, at most one stored; 0 for one that holds something else. Moves past
// the line.
std::size_t pass_line(TextCursor& cursor, double& first) {
  const TextPlace line{cursor.offset(), cursor.line()};
  try {
    if (const auto count = cursor.try_numbers({&first, 1})) return *count;
  } catch (const Error& error) {  // too long a line
    if (error.kind() != ErrorKind::input) throw;
    cursor.move_to(line.offset, line.line);
  }
  cursor.next_line();
  return 0;
}

// In a damaged file a line with one number starts a scan, whatever the number, and so does the first line.
std::vector<ScanEntry> list_damaged_pts(InputFile& input) {
  std::vector<ScanEntry> entries;
  TextCursor cursor(input, start_of_text(input));
  for (cursor.skip_blank_lines(); !cursor.at_end(); cursor.skip_blank_lines()) {
    const TextPlace line{cursor.offset(), cursor.line()};
    double value = 0;
    const std::size_t numbers = pass_line(cursor, value);
    if (numbers == 1 || entries.empty()) {
      check_scans(input, entries.size() + 1, line.line);
      ScanEntry& entry = entries.emplace_back();
      if (numbers == 1) cursor.skip_blank_lines();
      entry.offset = numbers == 1 ? cursor.offset() : line.offset;
      entry.line = numbers == 1 ? cursor.line() : line.line;
      if (numbers == 1 && value >= 0 && value <= kMostCounted)
        entry.announced = static_cast<std::uint64_t>(value);
      if (numbers == 1) continue;
    }
    ++entries.back().samples;
    entries.back().end = cursor.offset();
    if (entries.back().structure.empty() && numbers <= kMostColumns)
      entries.back().structure = kColumns[numbers];
  }
  for (ScanEntry& entry : entries)
    if (entry.structure.empty() && (entry.samples > 0 || entry.announced.value_or(1) > 0))
      entry.problem = fmt::format(
          "{}: line {}: expected points of 3, 4, 6 or 7 numbers, found none; copy or export the file again",
          input.name(), entry.line);
  const auto good = [](const ScanEntry& entry) { return entry.problem.empty(); };
  if (!entries.empty() && std::none_of(entries.begin(), entries.end(), good))
    throw Error(ErrorKind::input, entries.front().problem);
  return entries;
}

void read_point(TextCursor& cursor, std::span<double> values, std::uint64_t count, std::uint64_t done) {
  const std::uint64_t line = cursor.line();
  if (cursor.at_end())
    fail_input("{}: line {}: expected {} points, found {}; another process shortened the file: read it again",
               cursor.file(), line, count, done);
  const std::size_t found = cursor.read_numbers(values);
  if (found != values.size())
    fail_input(
        "{}: line {}: expected {} ({} numbers) as on the scan's first line, found {}; correct that line, or "
        "the count, or use --salvage",
        cursor.file(), line, kColumns[values.size()], values.size(), found);
}

class PtsStream : public TextStream {
 public:
  PtsStream(const std::filesystem::path& file, const ScanEntry& entry) : TextStream(file, entry) {
    TextCursor cursor(input(), entry.offset, entry.line);
    if (entry.samples > 0) columns_ = {check_columns(input().name(), io::read_line(cursor))};
    const auto notes = take({.start = {entry.offset, entry.line},
                             .count = entry.samples,
                             .columns = columns_.count,
                             .intensity = columns_.intensity(),
                             .colour = columns_.colour() ? ColourKind::byte : ColourKind::none});
    if (commas_seen()) head_.notes.emplace_back(kCommas);
    add_notes(notes);
    const SampleFacts& all = facts();
    if (has_intensity() && all.whole && all.least >= kLeastIntensity && all.greatest <= kGreatestIntensity)
      head_.intensity_limits = {kLeastIntensity, kGreatestIntensity};
  }

 private:
  ScanSample sample(const double* row) const override { return columns_.sample(row); }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const override {
    read_point(cursor, values, count(), done);
  }

  TextColumns columns_;
};

// What the first of `lines` lines that is a point has.
std::size_t first_columns(InputFile& input, const ScanEntry& entry) {
  TextCursor cursor(input, entry.offset, entry.line);
  std::size_t columns = 0;
  double value = 0;
  for (std::uint64_t i = 0; i < entry.samples && (columns > kMostColumns || kColumns[columns][0] == '\0');
       ++i) {
    cursor.skip_blank_lines();
    columns = pass_line(cursor, value);
  }
  return columns;
}

}  // namespace

std::vector<ScanEntry> list_pts(const std::filesystem::path& file, const ReadOptions& options) {
  InputFile input(file);
  TextCursor cursor(input, start_of_text(input));
  const PointLine first = read_line(cursor);
  if (first.end)
    fail_input(
        "{}: line {}: expected the number of points or a point, found the end of the file; copy or export it "
        "again",
        input.name(), first.place.line);
  std::vector<ScanEntry> entries;
  if (options.salvage)
    entries = list_damaged_pts(input);
  else if (first.numbers == 1)
    entries = list_all_counted(input, cursor, first);
  else
    entries.push_back(list_all(input, first));
  const std::string stem = file.stem().string();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].index = i;
    entries[i].unit = std::string("m");
    entries[i].name = entries.size() == 1 ? stem : fmt::format("{}-{}", stem, i);
  }
  return entries;
}

Scan read_pts(const std::filesystem::path& file, const ScanEntry& entry) {
  InputFile input(file);
  TextCursor cursor(input, entry.offset, entry.line);
  const std::size_t columns = entry.samples == 0 ? 3
                              : entry.salvage    ? first_columns(input, entry)
                                                 : check_columns(input.name(), read_line(cursor));
  Damage damage(input.name());
  const bool intensity = TextColumns{columns}.intensity(), colour = TextColumns{columns}.colour();
  ScanBuilder builder(input.name(), entry.name, entry.samples,
                      {.intensity = intensity,
                       .colour = colour ? ColourKind::byte : ColourKind::none,
                       .salvage = entry.salvage,
                       .exact = entry.exact});
  bool commas = false;
  add_text_samples(
      input, {entry.offset, entry.line}, entry.samples, columns, builder, commas,
      [&](const double* row) { return TextColumns{columns}.sample(row); },
      [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
        read_point(at, values, entry.samples, done);
      },
      entry.salvage ? &damage : nullptr);
  const std::uint64_t announced = entry.announced.value_or(entry.samples);
  if (announced > builder.size())
    damage.add(
        announced - builder.size(),
        fmt::format("byte {}: the points that the line before line {} counts end", entry.end, entry.line));
  if (announced < builder.size())
    builder.add_note(
        fmt::format("line {}: expected {} points as the line before says, found {}: all are used", entry.line,
                    announced, builder.size()));
  if (damage.records() > 0) builder.add_note(damage.note(std::max<std::uint64_t>(announced, builder.size())));
  if (commas) builder.add_note(kCommas);
  Scan scan = builder.finish();
  const bool whole = std::all_of(scan.intensity.begin(), scan.intensity.end(),
                                 [](float value) { return value == std::floor(value); });
  if (intensity && whole && within(scan.intensity, kLeastIntensity, kGreatestIntensity))
    scan.intensity_limits = {kLeastIntensity, kGreatestIntensity};
  return scan;
}

std::unique_ptr<ScanStream> stream_pts(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  return std::make_unique<PtsStream>(file, entry);
}

}  // namespace hybrid::io
