#include "io/text/xyz.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text/text_samples.hpp"
#include "io/text/text_stream.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kMostXyzColumns = 64;
constexpr int kMostHeaderLines = 100;
constexpr int kRowsLookedAt = 1000;  // rows that tell what columns without names are

constexpr std::array<std::string_view, 3> kColourNames = {"red", "green", "blue"};

using Column = std::optional<std::size_t>;

// What a file's columns are, and where its points begin.
struct XyzHeader {
  std::size_t columns = 0;
  std::array<Column, 3> xyz, rgb;
  Column intensity;
  ColourKind colour = ColourKind::none;
  std::uint64_t names_line = 0;  // 0: no names
  std::vector<std::string> unused;
  bool is_guess = false;               // which columns are the colour
  std::optional<std::uint64_t> count;  // of points, where the file says, on count_line
  std::uint64_t count_line = 0;
  TextPlace start;

  bool has_colour() const { return rgb[0] && rgb[1] && rgb[2]; }
  std::string structure() const {
    return std::string("x y z") + (intensity ? " intensity" : "") + (has_colour() ? " red green blue" : "");
  }
  ScanSample sample(const double* row) const {
    ScanSample sample{row[*xyz[0]], row[*xyz[1]], row[*xyz[2]], intensity ? row[*intensity] : 0, {}};
    if (has_colour()) sample.rgb = {row[*rgb[0]], row[*rgb[1]], row[*rgb[2]]};
    return sample;
  }
};

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

// "//X[m], "Y", Z" are x, y and z.
std::vector<std::string> column_names(std::string_view line) {
  std::vector<std::string> names;
  constexpr std::string_view kBetween = " \t,;\r", kDropped = "/#\"'";
  for (std::size_t at = 0; (at = line.find_first_not_of(kBetween, at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    std::string name = lower_case(line.substr(at, end - at));
    std::erase_if(name, [&](char c) { return kDropped.find(c) != kDropped.npos; });
    name.resize(std::min(name.find_first_of("[("), name.size()));
    if (!name.empty()) names.push_back(std::move(name));
    at = end;
  }
  return names;
}

Column* column_of(const std::string& name, XyzHeader& header) {
  const auto is = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is({"x", "easting"})) return &header.xyz[0];
  if (is({"y", "northing"})) return &header.xyz[1];
  if (is({"z", "height", "elevation"})) return &header.xyz[2];
  if (is({"r", "red", "diffuse_red"})) return &header.rgb[0];
  if (is({"g", "green", "diffuse_green"})) return &header.rgb[1];
  if (is({"b", "blue", "diffuse_blue"})) return &header.rgb[2];
  return is({"i", "reflectance", "amplitude"}) || names_intensity(name) ? &header.intensity : nullptr;
}

// Whether the line names x, y and z.
bool take_names(std::string_view line, XyzHeader& header) {
  XyzHeader named;
  named.count = header.count;
  named.count_line = header.count_line;
  for (const std::string& name : column_names(line)) {
    Column* column = column_of(name, named);
    if (column && !*column)
      *column = named.columns;
    else
      named.unused.push_back(name);
    ++named.columns;
  }
  if (!named.xyz[0] || !named.xyz[1] || !named.xyz[2] || named.columns > kMostXyzColumns) return false;
  if (!named.has_colour())
    for (std::size_t k = 0; k < 3; ++k)
      if (named.rgb[k]) named.unused.emplace_back(kColourNames[k]);
  header = std::move(named);
  return true;
}

struct FirstRows {
  std::vector<std::vector<double>> rows;

  // Whether `count` numbers from `from` on are bytes in all of them.
  bool bytes(std::size_t from, std::size_t count) const {
    return std::all_of(rows.begin(), rows.end(), [&](const auto& row) {
      return std::all_of(row.begin() + static_cast<std::ptrdiff_t>(from),
                         row.begin() + static_cast<std::ptrdiff_t>(from + count),
                         [](double v) { return v >= 0 && v <= 255 && v == std::floor(v); });
    });
  }
};

FirstRows first_rows(TextCursor& cursor, std::size_t columns) {
  FirstRows first;
  std::vector<double> values(columns);
  for (int i = 0; i < kRowsLookedAt; ++i) {
    cursor.skip_blank_lines();
    if (cursor.at_end() || cursor.try_numbers(values) != columns) break;
    first.rows.push_back(values);
  }
  return first;
}

void guess_columns(const FirstRows& first, XyzHeader& header) {
  header.xyz = {0, 1, 2};
  std::size_t used = 3;
  const auto colours_at = [&](std::size_t at) { header.rgb = {at, at + 1, at + 2}; };
  if (header.columns == 4) header.intensity = 3, used = 4;
  if (header.columns == 6 && first.bytes(3, 3)) colours_at(3), used = 6;
  if (header.columns == 7) {
    const bool may_be_last = first.bytes(4, 3), may_be_first = first.bytes(3, 3);
    header.is_guess = may_be_last && may_be_first;
    if (may_be_last)
      colours_at(4), header.intensity = 3, used = 7;
    else if (may_be_first)
      colours_at(3), header.intensity = 6, used = 7;
  }
  for (std::size_t k = used; k < header.columns; ++k)
    header.unused.push_back(fmt::format("column {}", k + 1));
}

// Whole numbers to 255, fractions to 1, or 16 bits.
ColourKind kind_of_colours(const FirstRows& first, const XyzHeader& header) {
  double largest = 0;
  bool whole = true;
  for (const auto& row : first.rows)
    for (const Column& column : header.rgb) {
      largest = std::max(largest, row[*column]);
      whole = whole && row[*column] == std::floor(row[*column]);
    }
  if (!whole) return ColourKind::real;
  return largest > 255 ? ColourKind::word : ColourKind::byte;
}

XyzHeader read_header(InputFile& input, TextCursor& cursor) {
  XyzHeader header;
  std::array<double, kMostXyzColumns> values{};
  std::optional<std::size_t> numbers;
  for (int lines = 0; !numbers; ++lines) {
    cursor.skip_blank_lines();
    if (cursor.at_end()) break;
    header.start = {cursor.offset(), cursor.line()};
    numbers = cursor.try_numbers(values);
    if (numbers == 1u && !header.count && values[0] >= 0 && values[0] == std::floor(values[0]) &&
        values[0] < std::numeric_limits<std::uint32_t>::max()) {
      header.count = static_cast<std::uint64_t>(values[0]);
      header.count_line = header.start.line;
      numbers.reset();
    } else if (!numbers) {
      const std::string line(cursor.next_line());
      if (take_names(line, header)) {
        header.names_line = cursor.line() - 1;
      } else if (!is_comment(line) || lines > kMostHeaderLines) {
        fail_input(
            "{}: line {}: expected numbers, or the names of columns with x, y and z among them, found {}; "
            "correct or remove that line",
            input.name(), cursor.line() - 1, in_quotes(line));
      }
    }
  }
  if (!numbers) {
    const bool named = header.names_line > 0;
    if (!named) header.columns = 3, header.xyz = {0, 1, 2};
    header.start = {cursor.offset(), cursor.line()};
    if (header.count.value_or(named ? 0 : 1) == 0) return header;
    fail_input("{}: line {}: expected points, found the end of the file; copy or export it again",
               input.name(), cursor.line());
  }
  cursor.move_to(header.start.offset, header.start.line);
  cursor.refuse_decimal_commas();
  if (*numbers < 3 || *numbers > kMostXyzColumns)
    fail_input(
        "{}: line {}: expected 3 to {} numbers (x y z and others), found {}; is this a text of points?",
        input.name(), header.start.line, kMostXyzColumns, *numbers);
  if (header.names_line > 0 && *numbers != header.columns)
    fail_input("{}: line {}: expected {} numbers, as line {} has names, found {}; correct the names",
               input.name(), header.start.line, header.columns, header.names_line, *numbers);
  header.columns = *numbers;
  const FirstRows first = first_rows(cursor, header.columns);
  if (header.names_line == 0) guess_columns(first, header);
  if (header.has_colour()) header.colour = kind_of_colours(first, header);
  return header;
}

XyzHeader open_header(InputFile& input) {
  TextCursor cursor(input, start_of_text(input));
  return read_header(input, cursor);
}

std::vector<std::string> notes_of(const XyzHeader& header) {
  std::vector<std::string> notes;
  if (header.is_guess)
    notes.emplace_back(
        "columns 4 to 7 are taken as intensity red green blue, but may be red green blue intensity: a first "
        "line of "
        "names tells");
  if (!header.unused.empty())
    notes.push_back(
        fmt::format("columns not used: {}{}", fmt::join(header.unused, ", "),
                    header.names_line == 0 ? " (a first line of names tells what they are)" : ""));
  return notes;
}

void read_row(TextCursor& cursor, std::span<double> values, const XyzHeader& header) {
  const std::uint64_t line = cursor.line();
  if (cursor.at_end())
    fail_input(
        "{}: line {}: expected more points, found the end; another process shortened the file: read it again",
        cursor.file(), line);
  const std::size_t found = cursor.read_numbers(values);
  if (found != values.size())
    fail_input("{}: line {}: expected {} numbers as on line {}, found {}; correct that line, {}",
               cursor.file(), line, values.size(), header.start.line, found, kSalvageRemedy);
}

class XyzStream : public TextStream {
 public:
  XyzStream(const std::filesystem::path& file, const ScanEntry& entry) : TextStream(file, entry) {
    header_ = open_header(input());
    const auto notes = take({.start = header_.start,
                             .count = entry.samples,
                             .columns = header_.columns,
                             .intensity = header_.intensity.has_value(),
                             .colour = header_.colour});
    add_notes(notes_of(header_));
    add_notes(notes);
  }

 private:
  ScanSample sample(const double* row) const override { return header_.sample(row); }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t) const override {
    read_row(cursor, values, header_);
  }

  XyzHeader header_;
};

}  // namespace

std::vector<ScanEntry> list_xyz(const std::filesystem::path& file, const ReadOptions& options) {
  InputFile input(file);
  const XyzHeader header = open_header(input);
  ScanEntry entry{.name = file.stem().string(), .structure = header.structure(), .unit = "m"};
  entry.offset = header.start.offset;
  entry.line = header.start.line;
  entry.samples = pass_rows(input, header.start, input.size(), ~std::uint64_t{0}).rows;
  entry.announced = header.count;
  if (!options.salvage && header.count && *header.count != entry.samples)
    fail_input(
        "{}: line {}: expected {} points as it says, found {}; the file is cut short, or the count wrong: "
        "copy or "
        "export it again, or correct the count, {}",
        input.name(), header.count_line, *header.count, entry.samples, kSalvageRemedy);
  return {entry};
}

Scan read_xyz(const std::filesystem::path& file, const ScanEntry& entry) {
  InputFile input(file);
  const XyzHeader header = open_header(input);
  Damage damage(input.name());
  ScanBuilder builder(input.name(), entry.name, entry.samples,
                      {.intensity = header.intensity.has_value(),
                       .colour = header.colour,
                       .salvage = entry.salvage,
                       .exact = entry.exact});
  for (std::string& note : notes_of(header)) builder.add_note(std::move(note));
  bool commas = false;
  add_text_samples(
      input, header.start, entry.samples, header.columns, builder, commas,
      [&](const double* row) { return header.sample(row); },
      [&](TextCursor& at, std::span<double> values, std::uint64_t) { read_row(at, values, header); },
      entry.salvage ? &damage : nullptr);
  const std::uint64_t announced = entry.announced.value_or(builder.size());
  if (announced > builder.size())
    damage.add(announced - builder.size(), "the file ends before the points that it counts");
  if (damage.records() > 0) builder.add_note(damage.note(std::max<std::uint64_t>(announced, builder.size())));
  return builder.finish();
}

std::unique_ptr<ScanStream> stream_xyz(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  return std::make_unique<XyzStream>(file, entry);
}

}  // namespace hybrid::io
