#include "io/ply.hpp"

#include <optional>

#include "core/error.hpp"
#include "io/mapped_file.hpp"
#include "io/ply_header.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {
namespace {

using Index = std::optional<std::size_t>;

// The vertex properties that become a Scan, by their place in the element.
struct UsedProperties {
  Index x, y, z, intensity, red, green, blue;
  bool colour() const { return red && green && blue; }
};

UsedProperties find_properties(const std::string& file, const PlyElement& vertex, std::string& unused) {
  UsedProperties used;
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    Index* slot = nullptr;
    if (!property.list) {
      if (property.name == "x") slot = &used.x;
      if (property.name == "y") slot = &used.y;
      if (property.name == "z") slot = &used.z;
      if (names_intensity(property.name)) slot = &used.intensity;
      if (property.name == "red") slot = &used.red;
      if (property.name == "green") slot = &used.green;
      if (property.name == "blue") slot = &used.blue;
    }
    if (slot && *slot)
      fail_input(
          "{}: line {}: expected property {} once in element vertex, found it again; correct the header",
          file, vertex.line, in_quotes(property.name));
    if (slot)
      *slot = i;
    else
      unused += (unused.empty() ? "" : " ") + property.name;
  }
  if (!used.x || !used.y || !used.z)
    fail_input(
        "{}: line {}: expected properties x, y and z in element vertex, found no {}; is this a point cloud?",
        file, vertex.line, !used.x ? "x" : (!used.y ? "y" : "z"));
  return used;
}

// One sample: number(i) is the value of property i.
template <typename Number>
void add_sample(ScanBuilder& builder, const UsedProperties& used, const Number& number) {
  builder.add_point(number(*used.x), number(*used.y), number(*used.z));
  if (used.intensity) builder.add_intensity(number(*used.intensity));
  if (used.colour()) builder.add_colour(number(*used.red), number(*used.green), number(*used.blue));
}

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file)
      : mapped_(file),
        file_(mapped_.name()),
        text_(without_byte_order_mark(file_, mapped_.bytes())),
        header_(read_ply_header(file_, text_)),
        data_(text_.substr(header_.data_offset)),
        cursor_(file_, data_, header_.data_line),
        name_(file.stem().string()) {}

  Scan read() {
    std::optional<ScanBuilder> builder;
    std::string others;
    for (const PlyElement& element : header_.elements) {
      check_count_fits(file_, fmt::format("line {}", element.line), element.name.c_str(), element.count,
                       ascii() ? 2 * element.properties.size() : element.least_bytes(),
                       ascii() ? cursor_.remaining() + 1 : data_.size() - at_);
      if (element.name == "vertex") {
        builder.emplace(read_vertices(element));
      } else {
        skip(element);
        others += fmt::format("{}{} {}", others.empty() ? "" : ", ", element.count, element.name);
      }
    }
    if (!builder)
      fail_input(
          "{}: line {}: expected an element named vertex before end_header, found none; this PLY file has no "
          "points",
          file_, header_.data_line - 1);
    if (!others.empty()) builder->add_note("elements not used: " + others);
    note_rest(*builder);
    return builder->finish();
  }

 private:
  bool ascii() const { return header_.format == PlyFormat::ascii; }
  bool swap() const { return header_.format == PlyFormat::big_endian; }

  // Where a byte of the data lies in the file.
  std::size_t byte(std::size_t offset) const {
    return static_cast<std::size_t>(data_.data() - mapped_.bytes().data()) + offset;
  }

  ScanBuilder read_vertices(const PlyElement& vertex) {
    std::string unused;
    const UsedProperties used = find_properties(file_, vertex, unused);
    ColourKind colour = ColourKind::none;
    if (used.colour()) colour = colour_kind(vertex.properties[*used.red].type);
    ScanBuilder builder(file_, name_, vertex.count,
                        {.intensity = used.intensity.has_value(), .colour = colour});
    if (!unused.empty()) builder.add_note("properties not used: " + unused);
    places_.assign(vertex.properties.size(), 0);
    if (ascii()) {
      const auto number = [&](std::size_t i) { return values_[places_[i]]; };
      for (std::uint64_t row = 0; row < vertex.count; ++row) {
        read_line(vertex, row);
        add_sample(builder, used, number);
      }
    } else {
      const auto number = [&](std::size_t i) {
        return load_scalar(data_.data() + places_[i], vertex.properties[i].type, swap());
      };
      for (std::uint64_t row = 0; row < vertex.count; ++row) {
        find_places(vertex, row);
        add_sample(builder, used, number);
      }
    }
    return builder;
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    if (!ascii() && !element.has_lists()) {
      at_ += element.count * element.least_bytes();
      return;
    }
    places_.assign(element.properties.size(), 0);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (ascii()) {
        start_line(element, row);
        cursor_.next_line();
      } else {
        find_places(element, row);
      }
    }
  }

  void start_line(const PlyElement& element, std::uint64_t row) {
    cursor_.skip_blank_lines();
    if (cursor_.at_end())
      fail_input(
          "{}: line {}: expected {} records of element {}, found {}; the file is cut short: copy or export "
          "it "
          "again",
          file_, cursor_.line(), element.count, element.name, row);
  }

  // Reads an ascii record into values_; places_[i] is where property i stands in it (of a list: its count).
  void read_line(const PlyElement& element, std::uint64_t row) {
    start_line(element, row);
    const std::uint64_t line = cursor_.line();
    cursor_.read_all_numbers(values_);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      places_[i] = expected;
      if (element.properties[i].list && expected < values_.size()) {
        const double count = values_[expected];
        if (!(count >= 0 && count < static_cast<double>(values_.size())))
          fail_input("{}: line {}: expected the count of list {}, found {}", file_, line,
                     in_quotes(element.properties[i].name), count);
        expected += static_cast<std::size_t>(count);
      }
      ++expected;
    }
    if (values_.size() != expected)
      fail_input("{}: line {}: expected {} values as the properties of {} say, found {}; correct that line",
                 file_, line, expected, element.name, values_.size());
  }

  // Steps over a binary record; places_[i] is where property i stands in the data.
  void find_places(const PlyElement& element, std::uint64_t row) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      places_[i] = at_;
      double count = 1;
      if (property.list) {
        need(size_of(property.count_type), element, row);
        count = load_scalar(data_.data() + at_, property.count_type, swap());
        if (count < 0)
          fail_input("{}: byte {}: expected the count of list {} of {} {}, found {}; the file is damaged",
                     file_, byte(at_), in_quotes(property.name), element.name, row, count);
        at_ += size_of(property.count_type);
      }
      const auto size = static_cast<double>(size_of(property.type));
      need(count * size, element, row);
      at_ += static_cast<std::size_t>(count * size);
    }
  }

  void need(double bytes, const PlyElement& element, std::uint64_t row) const {
    if (bytes > static_cast<double>(data_.size() - at_))
      fail_input(
          "{}: byte {}: expected {} more bytes for {} {} of {}, found {}; the file is cut short: copy or "
          "export "
          "it again",
          file_, byte(at_), bytes, element.name, row, element.count, data_.size() - at_);
  }

  void note_rest(ScanBuilder& builder) {
    if (ascii()) {
      cursor_.skip_blank_lines();
      if (cursor_.commas_seen())
        builder.add_note("values are separated by commas, which PLY does not provide for");
      if (!cursor_.at_end())
        builder.add_note(fmt::format("line {}: {} bytes after the last record are ignored", cursor_.line(),
                                     cursor_.remaining()));
    } else if (at_ < data_.size()) {
      builder.add_note(
          fmt::format("byte {}: {} bytes after the last record are ignored", byte(at_), data_.size() - at_));
    }
  }

  MappedFile mapped_;
  const std::string& file_;
  std::string_view text_;
  PlyHeader header_;
  std::string_view data_;
  TextCursor cursor_;   // ascii: in data_
  std::size_t at_ = 0;  // binary: in data_
  std::string name_;
  std::vector<double> values_;
  std::vector<std::size_t> places_;
};

}  // namespace

Scan read_ply(const std::filesystem::path& file) {
  return PlyReader(file).read();
}

}  // namespace hybrid::io
