#include "io/ply.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "io/input_file.hpp"
#include "io/ply_header.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"
#include "io/text_samples.hpp"

namespace hybrid::io {
namespace {

using Index = std::optional<std::size_t>;

constexpr double kTwoTo64 = 18446744073709551616.0;

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
ScanSample make_sample(const UsedProperties& used, const Number& number) {
  ScanSample sample{number(*used.x), number(*used.y), number(*used.z), 0, {}};
  if (used.intensity) sample.intensity = number(*used.intensity);
  if (used.colour()) sample.rgb = {number(*used.red), number(*used.green), number(*used.blue)};
  return sample;
}

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, const ReadOptions& options)
      : input_(file),
        file_(input_.name()),
        salvage_(options.salvage),
        exact_(options.exact),
        damage_(file_),
        header_(read_ply_header(input_)),
        at_(header_.data_offset),
        cursor_(input_, header_.data_offset, header_.data_line),
        name_(file.stem().string()) {}

  Scan read() {
    std::optional<ScanBuilder> builder;
    std::string others;
    for (const PlyElement& element : header_.elements) {
      if (salvage_ && element.name == "vertex") {
        builder.emplace(salvage_vertices(element));
        continue;
      }
      if (salvage_ && builder && cut_short_) continue;  // what follows the points cannot be found
      check_count_fits(file_, fmt::format("line {}", element.line), element.name.c_str(), element.count,
                       ascii() ? 2 * element.properties.size() : element.least_bytes(),
                       ascii() ? cursor_.remaining() + 1 : rest(), element.name == "vertex");
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
    if (!cut_short_) note_rest(*builder);
    return builder->finish();
  }

 private:
  bool ascii() const { return header_.format == PlyFormat::ascii; }
  bool swap() const { return header_.format == PlyFormat::big_endian; }

  std::uint64_t rest() const { return input_.size() - at_; }  // binary

  // As many of them as there are; lines that are none are no-returns.
  ScanBuilder salvage_vertices(PlyElement vertex) {
    const std::uint64_t announced = vertex.count;
    const std::uint64_t least = ascii() ? 2 * vertex.properties.size() : vertex.least_bytes();
    const std::uint64_t room =
        (ascii() ? cursor_.remaining() + 1 : rest()) / std::max<std::uint64_t>(least, 1);
    vertex.count = std::min(vertex.count, room);
    ScanBuilder builder = read_vertices(vertex);
    const std::uint64_t offset = ascii() ? cursor_.offset() : at_;
    if (builder.size() < announced) {
      cut_short_ = true;
      damage_.add(announced - builder.size(),
                  !list_problem_.empty()
                      ? list_problem_
                      : fmt::format("byte {}: the points that line {} announces end", offset, vertex.line));
    }
    if (damage_.records() > 0) builder.add_note(damage_.note(announced));
    return builder;
  }

  // Reads a record; what is wrong with it when salvage is to pass it by.
  template <typename Read>
  std::string problem_of(const Read& read) {
    try {
      read();
    } catch (const Error& error) {
      if (!salvage_ || error.kind() != ErrorKind::input) throw;
      return error.what();
    }
    return {};
  }

  ScanBuilder read_vertices(const PlyElement& vertex) {
    std::string unused;
    const UsedProperties used = find_properties(file_, vertex, unused);
    ColourKind colour = ColourKind::none;
    if (used.colour()) colour = colour_kind(vertex.properties[*used.red].type);
    // Single precision holds what was written in it; text may have more digits than its header says.
    const bool rounds = ascii() || std::ranges::any_of(std::array{used.x, used.y, used.z}, [&](Index place) {
                          return vertex.properties[*place].type != ScalarType::f32;
                        });
    ScanBuilder builder(file_, name_, vertex.count,
                        {.intensity = used.intensity.has_value(),
                         .colour = colour,
                         .salvage = salvage_,
                         .exact = exact_ && rounds});
    if (!unused.empty()) builder.add_note("properties not used: " + unused);
    places_.assign(vertex.properties.size(), 0);
    if (ascii() && !vertex.has_lists()) {
      read_number_rows(vertex, used, builder);
    } else if (ascii()) {
      const auto number = [&](std::size_t i) { return values_[places_[i]]; };
      for (std::uint64_t row = 0; row < vertex.count; ++row) {
        cursor_.skip_blank_lines();
        if (salvage_ && cursor_.at_end()) break;
        const TextPlace line{cursor_.offset(), cursor_.line()};
        const std::string problem = problem_of([&] { read_line(vertex, row); });
        if (problem.empty()) {
          builder.add(make_sample(used, number));
          continue;
        }
        damage_.add(1, problem);
        builder.add_lost(1);
        cursor_.move_to(line.offset, line.line);
        cursor_.next_line();
      }
    } else {
      const auto number = [&](std::size_t i) {
        const ScalarType type = vertex.properties[i].type;
        return load_scalar(input_.at(places_[i], size_of(type)), type, swap());
      };
      for (std::uint64_t row = 0; row < vertex.count; ++row) {
        // Behind a record whose lists make no sense nothing has a place.
        list_problem_ = problem_of([&] { find_places(vertex, row); });
        if (!list_problem_.empty()) break;
        builder.add(make_sample(used, number));
      }
    }
    return builder;
  }

  // As many numbers on every line.
  void read_number_rows(const PlyElement& vertex, const UsedProperties& used, ScanBuilder& builder) {
    if (vertex.count == 0) return;
    const TextPlace after = add_text_samples(
        input_, {cursor_.offset(), cursor_.line()}, vertex.count, vertex.properties.size(), builder, commas_,
        [&](const double* row) { return make_sample(used, [&](std::size_t i) { return row[i]; }); },
        [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
          cursor_.move_to(at.offset(), at.line());
          read_line(vertex, done);
          std::copy(values_.begin(), values_.end(), values.begin());
          at.move_to(cursor_.offset(), cursor_.line());
        },
        salvage_ ? &damage_ : nullptr);
    cursor_.move_to(after.offset, after.line);
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    if (!ascii() && !element.has_lists()) {
      at_ += element.count * element.least_bytes();
      return;
    }
    places_.assign(element.properties.size(), 0);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (ascii())
        read_line(element, row);
      else
        find_places(element, row);
    }
  }

  void start_line(const PlyElement& element, std::uint64_t row) {
    cursor_.skip_blank_lines();
    if (cursor_.at_end())
      fail_input(
          "{}: line {}: expected {} records of element {}, found {}; the file is cut short: copy or export "
          "it again, {}",
          file_, cursor_.line(), element.count, element.name, row, kSalvageRemedy);
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
        if (!(count >= 0 && count < static_cast<double>(values_.size())) || count != std::floor(count))
          fail_input(
              "{}: line {}: expected the count of list {} of {}, found {}; correct that line, or the "
              "counts in the header",
              file_, line, in_quotes(element.properties[i].name), element.name, count);
        expected += static_cast<std::size_t>(count);
      }
      ++expected;
    }
    if (values_.size() != expected)
      fail_input("{}: line {}: expected {} values as the properties of {} say, found {}; correct that line",
                 file_, line, expected, element.name, values_.size());
  }

  // Steps over a binary record; places_[i] is where property i stands in the file.
  void find_places(const PlyElement& element, std::uint64_t row) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      places_[i] = at_;
      std::uint64_t count = 1;
      if (property.list) {
        need(1, size_of(property.count_type), element, row);
        const double value =
            load_scalar(input_.at(at_, size_of(property.count_type)), property.count_type, swap());
        if (value < 0)
          fail_input("{}: byte {}: expected the count of list {} of {} {}, found {}; the file is damaged",
                     file_, at_, in_quotes(property.name), element.name, row, value);
        at_ += size_of(property.count_type);
        count = value < kTwoTo64 ? static_cast<std::uint64_t>(value) : ~std::uint64_t{0};
      }
      need(count, size_of(property.type), element, row);
      at_ += count * size_of(property.type);
    }
  }

  void need(std::uint64_t count, std::uint64_t size, const PlyElement& element, std::uint64_t row) const {
    if (count > rest() / size)
      fail_input(
          "{}: byte {}: expected {} values of {} bytes for {} {} of {}, found {} bytes; the file is cut "
          "short: copy or export it again, {}",
          file_, at_, count, size, element.name, row, element.count, rest(), kSalvageRemedy);
  }

  // A further vertex means that the header is wrong; anything else is told.
  void note_rest(ScanBuilder& builder) {
    const PlyElement& last = header_.elements.back();
    const bool countable = last.name == "vertex" && !last.has_lists();
    if (ascii()) {
      cursor_.skip_blank_lines();
      if (commas_ || cursor_.commas_seen())
        builder.add_note("values are separated by commas, which PLY does not provide for");
      if (cursor_.at_end()) return;
      const std::uint64_t line = cursor_.line(), bytes = cursor_.remaining();
      if (countable && !salvage_ && cursor_.next_line_is_numbers(last.properties.size()))
        fail_input(
            "{}: line {}: expected the end of the file after {} vertices, found another vertex; correct "
            "\"element vertex\" in the header, {}",
            file_, line, last.count, kSalvageRemedy);
      builder.add_note(fmt::format("line {}: {} bytes after the last record are ignored", line, bytes));
    } else if (rest() > 0) {
      check_not_sent_as_text(input_, header_.data_offset);
      if (countable && !salvage_ && rest() >= last.least_bytes() && !input_.only_zeros_from(at_))
        fail_input(
            "{}: byte {}: expected the end of the file after {} vertices, found {} more bytes, room for {} "
            "vertices; correct \"element vertex\" in the header, {}",
            file_, at_, last.count, rest(), rest() / last.least_bytes(), kSalvageRemedy);
      builder.add_note(fmt::format("byte {}: {} bytes after the last record are ignored", at_, rest()));
    }
  }

  InputFile input_;
  const std::string& file_;
  bool salvage_, exact_, cut_short_ = false;
  Damage damage_;
  std::string list_problem_;
  PlyHeader header_;
  std::uint64_t at_;   // binary: in the file
  TextCursor cursor_;  // ascii
  bool commas_ = false;
  std::string name_;
  std::vector<double> values_;
  std::vector<std::uint64_t> places_;
};

const char* name_of(PlyFormat format) {
  return format == PlyFormat::ascii           ? "ascii"
         : format == PlyFormat::little_endian ? "binary little endian"
                                              : "binary big endian";
}

}  // namespace

Scan read_ply(const std::filesystem::path& file, const ReadOptions& options) {
  return PlyReader(file, options).read();
}

std::vector<ScanEntry> list_ply(const std::filesystem::path& file) {
  InputFile input(file);
  const PlyHeader header = read_ply_header(input);
  ScanEntry entry{.name = file.stem().string(), .structure = fmt::format("{},", name_of(header.format))};
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    entry.samples = element.count;
    for (const PlyProperty& property : element.properties) entry.structure += " " + property.name;
  }
  entry.offset = header.data_offset;
  entry.line = header.data_line;
  entry.end = input.size();
  return {entry};
}

}  // namespace hybrid::io
