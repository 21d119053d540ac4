#include "io/ply/ply_header.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

using Words = std::vector<std::string_view>;

class HeaderReader {
 public:
  explicit HeaderReader(InputFile& input)
      : file_(input.name()), cursor_(input, start_of_text(input), 1, kLongestHeaderLine_bytes) {}

  PlyHeader read() {
    const std::string_view magic = cursor_.next_line();
    if (words(magic) != Words{"ply"})
      fail_input("{}: line 1: expected \"ply\", found {}; is this a PLY file?", file_, in_quotes(magic));
    const bool lone_returns = cursor_.last_line_end() == "\r";
    bool format_seen = false;
    for (Words line = next(); !(line.size() == 1 && line[0] == "end_header"); line = next()) {
      if (line.empty() || line[0] == "comment" || line[0] == "obj_info") continue;
      if (line[0] == "format") {
        read_format(line);
        format_seen = true;
      } else if (line[0] == "element") {
        read_element(line);
      } else if (line[0] == "property") {
        read_property(line);
      } else {
        fail_line("format, comment, obj_info, element, property or end_header", line);
      }
    }
    if (!format_seen)
      fail_input("{}: line {}: expected a format line in the header, found none", file_, cursor_.line() - 1);
    header_.data_offset = cursor_.offset();
    // Where a lone CR ends the lines, a line feed after end_header is the first byte of the data.
    if (lone_returns && cursor_.last_line_end() == "\r\n") --header_.data_offset;
    header_.data_line = cursor_.line();
    return std::move(header_);
  }

 private:
  Words next() {
    line_ = cursor_.line();
    if (cursor_.at_end())
      fail_input("{}: line {}: expected end_header, found the end of the file; the file is cut short", file_,
                 line_);
    return words(cursor_.next_line());
  }

  [[noreturn]] void fail_line(const char* expected, const Words& line) const {
    fail_input("{}: line {}: expected {}, found {}; correct the header", file_, line_, expected,
               in_quotes(fmt::format("{}", fmt::join(line, " "))));
  }

  void read_format(const Words& line) {
    static const std::map<std::string_view, PlyFormat> known{
        {"ascii", PlyFormat::ascii},
        {"binary_little_endian", PlyFormat::little_endian},
        {"binary_big_endian", PlyFormat::big_endian}};
    if (line.size() != 3 || !known.contains(line[1]) || line[2] != "1.0")
      fail_line("format ascii, binary_little_endian or binary_big_endian, version 1.0", line);
    header_.format = known.at(line[1]);
  }

  void read_element(const Words& line) {
    PlyElement element;
    if (line.size() != 3 || !parse_whole(line[2], element.count)) fail_line("element NAME COUNT", line);
    element.name = line[1];
    element.line = line_;
    if (!element_names_.insert(element.name).second) fail_line("every element once", line);
    header_.elements.push_back(std::move(element));
  }

  ScalarType scalar_type(std::string_view name, const Words& line) const {
    using enum ScalarType;
    static const std::map<std::string_view, ScalarType> known{
        {"char", i8},   {"uchar", u8},    {"short", i16},  {"ushort", u16},  {"int", i32},   {"uint", u32},
        {"int8", i8},   {"uint8", u8},    {"int16", i16},  {"uint16", u16},  {"int32", i32}, {"uint32", u32},
        {"float", f32}, {"float32", f32}, {"double", f64}, {"float64", f64}, {"int64", i64}, {"uint64", u64}};
    const auto found = known.find(name);
    if (found == known.end()) fail_line("a type (char uchar short ushort int uint float double)", line);
    return found->second;
  }

  void read_property(const Words& line) {
    if (header_.elements.empty()) fail_line("an element before its properties", line);
    PlyProperty property;
    property.list = line.size() == 5 && line[1] == "list";
    if (!property.list && line.size() != 3)
      fail_line("property TYPE NAME or property list TYPE TYPE NAME", line);
    if (property.list) {
      property.count_type = scalar_type(line[2], line);
      if (is_real(property.count_type)) fail_line("a whole type for the count of a list", line);
    }
    property.type = scalar_type(line[line.size() - 2], line);
    property.name = lower_case(line.back());
    header_.elements.back().properties.push_back(std::move(property));
  }

  const std::string& file_;
  TextCursor cursor_;
  std::uint64_t line_ = 0;
  std::set<std::string> element_names_;
  PlyHeader header_;
};

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.list; });
}

std::uint64_t PlyElement::least_bytes() const {
  std::uint64_t sum = 0;
  for (const PlyProperty& property : properties)
    sum += size_of(property.list ? property.count_type : property.type);
  return sum;
}

PlyHeader read_ply_header(InputFile& file) {
  return HeaderReader(file).read();
}

}  // namespace hybrid::io
