#include "io/pcd/pcd_header.hpp"

#include <cmath>
#include <limits>
#include <map>

#include "core/error.hpp"
#include "io/salvage.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

struct HeaderLine {
  std::uint64_t number = 0;
  std::vector<std::string> values;  // after the keyword
};

// The lines of a header by keyword.
class HeaderLines {
 public:
  HeaderLines(const std::string& file, TextCursor& cursor) : file_(file) {
    while (!lines_.contains("DATA")) {
      if (cursor.at_end())
        fail_input(
            "{}: line {}: expected the header line DATA, found the end of the file; the file is cut short",
            file, cursor.line());
      const std::uint64_t number = cursor.line();
      const auto line = words(cursor.next_line());
      if (!line.empty() && !line[0].starts_with('#')) add(number, line);
    }
  }

  bool has(const std::string& keyword) const { return lines_.contains(keyword); }
  std::uint64_t number(const std::string& keyword) const { return lines_.at(keyword).number; }

  // The values of a keyword, which must be `count` (0: any).
  const std::vector<std::string>& values(const std::string& keyword, std::size_t count = 0) const {
    if (!has(keyword))
      fail_input("{}: line {}: expected a {} line before DATA, found none; this is no complete PCD header",
                 file_, number("DATA"), keyword);
    const HeaderLine& line = lines_.at(keyword);
    if (line.values.empty() || (count != 0 && line.values.size() != count))
      fail_input("{}: line {}: expected {} values after {}, found {}; correct the header", file_, line.number,
                 count == 0 ? 1 : count, keyword, line.values.size());
    return line.values;
  }

  std::uint64_t whole(const std::string& keyword, std::size_t index, std::size_t count) const {
    std::uint64_t value = 0;
    const std::string_view word = values(keyword, count)[index];
    if (!parse_whole(word, value))
      fail_input("{}: line {}: expected a whole number after {}, found {}; correct the header", file_,
                 number(keyword), keyword, in_quotes(word));
    return value;
  }

 private:
  void add(std::uint64_t number, const std::vector<std::string_view>& line) {
    const std::string keyword(line[0] == "COLUMNS" ? "FIELDS" : line[0]);  // PCD 0.5
    constexpr std::string_view kKnown = " VERSION FIELDS SIZE TYPE COUNT WIDTH HEIGHT VIEWPOINT POINTS DATA ";
    if (kKnown.find(" " + keyword + " ") == kKnown.npos)
      fail_input(
          "{}: line {}: expected a PCD header keyword (VERSION, FIELDS, SIZE, ..., DATA), found {}; is this "
          "a PCD file with its header?",
          file_, number, in_quotes(line[0]));
    if (!lines_.try_emplace(keyword, HeaderLine{number, {line.begin() + 1, line.end()}}).second)
      fail_input("{}: line {}: expected {} once, found it again; correct the header", file_, number, keyword);
  }

  const std::string& file_;
  std::map<std::string, HeaderLine> lines_;
};

ScalarType scalar_type(const std::string& file, const HeaderLines& lines, std::string_view type,
                       std::uint64_t size) {
  using enum ScalarType;
  static const std::map<std::pair<std::string_view, std::uint64_t>, ScalarType> known{
      {{"I", 1}, i8},  {{"U", 1}, u8},  {{"I", 2}, i16}, {{"U", 2}, u16}, {{"I", 4}, i32},
      {{"U", 4}, u32}, {{"I", 8}, i64}, {{"U", 8}, u64}, {{"F", 4}, f32}, {{"F", 8}, f64}};
  const auto found = known.find({type, size});
  if (found == known.end())
    fail_input("{}: line {}: expected TYPE I, U or F with a SIZE of 1, 2, 4, 8 (F: 4, 8), found {} with {}",
               file, lines.number("TYPE"), in_quotes(type), size);
  return found->second;
}

void read_fields(const std::string& file, const HeaderLines& lines, PcdHeader& header) {
  const auto& names = lines.values("FIELDS");
  for (std::size_t i = 0; i < names.size(); ++i) {
    PcdField field{lower_case(names[i])};
    field.type =
        scalar_type(file, lines, lines.values("TYPE", names.size())[i], lines.whole("SIZE", i, names.size()));
    if (lines.has("COUNT")) field.count = lines.whole("COUNT", i, names.size());
    if (field.count == 0 || field.count > std::numeric_limits<std::uint32_t>::max())
      fail_input("{}: line {}: expected COUNT of {} to be at least 1, found {}; correct the header", file,
                 lines.number("COUNT"), in_quotes(names[i]), field.count);
    field.byte_offset = header.point_bytes;
    field.value_offset = header.point_values;
    header.point_bytes += size_of(field.type) * field.count;
    header.point_values += field.count;
    header.fields.push_back(std::move(field));
  }
}

void read_extent(const std::string& file, const HeaderLines& lines, PcdHeader& header) {
  header.width = lines.whole("WIDTH", 0, 1);
  if (lines.has("HEIGHT")) header.height = lines.whole("HEIGHT", 0, 1);
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if ((header.height > 1 && header.width > kMost) || header.height > kMost)
    fail_input("{}: line {}: expected a grid of at most {} x {}, found WIDTH {} and HEIGHT {}", file,
               lines.number("WIDTH"), kMost, kMost, header.width, header.height);
  header.points = header.width * header.height;
  if (lines.has("POINTS") && lines.whole("POINTS", 0, 1) != header.points)
    fail_input(
        "{}: line {}: expected POINTS to be WIDTH x HEIGHT = {} x {} = {}, found {}; correct the header, "
        "or use --salvage",
        file, lines.number("POINTS"), header.width, header.height, header.points,
        lines.whole("POINTS", 0, 1));
}

void read_viewpoint(const std::string& file, const HeaderLines& lines, PcdHeader& header) {
  if (!lines.has("VIEWPOINT")) return;
  double norm2 = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    double& value = header.viewpoint[i];
    const std::string_view word = lines.values("VIEWPOINT", 7)[i];
    if (!parse_real(word, value) || !std::isfinite(value))
      fail_input("{}: line {}: expected 7 finite numbers after VIEWPOINT (tx ty tz qw qx qy qz), found {}",
                 file, lines.number("VIEWPOINT"), in_quotes(word));
    if (i >= 3) norm2 += value * value;
  }
  if (std::abs(norm2 - 1) > 1e-2)
    fail_input(
        "{}: line {}: expected a unit quaternion qw qx qy qz in VIEWPOINT, found one of squared length {}; "
        "write 0 0 0 "
        "1 0 0 0 when the scanner's pose is unknown, or use --salvage",
        file, lines.number("VIEWPOINT"), norm2);
}

}  // namespace

PcdHeader read_pcd_header(InputFile& input, bool salvage) {
  const std::string& file = input.name();
  TextCursor cursor(input, start_of_text(input), 1, kLongestHeaderLine_bytes);
  const HeaderLines lines(file, cursor);
  PcdHeader header;
  read_fields(file, lines, header);
  const auto forgive = [&](const auto& read, const auto& instead) {
    try {
      read(file, lines, header);
    } catch (const Error& error) {
      if (!salvage || error.kind() != ErrorKind::input) throw;
      header.notes.push_back(Damage(file).shortened(error.what()));
      instead();
    }
  };
  forgive(read_extent, [&] {
    header.points = header.width = lines.whole("POINTS", 0, 1);
    header.height = 1;
  });
  forgive(read_viewpoint, [&] { header.viewpoint = PcdHeader{}.viewpoint; });
  const std::string_view data = lines.values("DATA", 1)[0];
  if (data == "binary")
    header.data = PcdData::binary;
  else if (data == "binary_compressed")
    header.data = PcdData::binary_compressed;
  else if (data != "ascii")
    fail_input("{}: line {}: expected DATA ascii, binary or binary_compressed, found {}", file,
               lines.number("DATA"), in_quotes(data));
  header.data_offset = cursor.offset();
  header.data_line = cursor.line();
  return header;
}

}  // namespace hybrid::io
