#include "io/ply/ply_elements.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {
namespace {

constexpr double kTwoTo64 = 18446744073709551616.0;

}  // namespace

PlyVertex::PlyVertex(const std::string& file, const PlyElement& vertex) {
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    Index* slot = nullptr;
    if (!property.list) {
      if (property.name == "x") slot = &x_;
      if (property.name == "y") slot = &y_;
      if (property.name == "z") slot = &z_;
      if (names_intensity(property.name)) slot = &intensity_;
      if (property.name == "red") slot = &red_;
      if (property.name == "green") slot = &green_;
      if (property.name == "blue") slot = &blue_;
    }
    if (slot && *slot)
      fail_input(
          "{}: line {}: expected property {} once in element vertex, found it again; correct the header",
          file, vertex.line, in_quotes(property.name));
    if (slot)
      *slot = i;
    else
      unused_ += (unused_.empty() ? "" : " ") + property.name;
  }
  if (!x_ || !y_ || !z_)
    fail_input(
        "{}: line {}: expected properties x, y and z in element vertex, found no {}; is this a point cloud?",
        file, vertex.line, !x_ ? "x" : (!y_ ? "y" : "z"));
  if (red_ && green_ && blue_) colour_ = colour_kind(vertex.properties[*red_].type);
  rounds_ = std::ranges::any_of(
      std::array{x_, y_, z_}, [&](Index place) { return vertex.properties[*place].type != ScalarType::f32; });
}

PlyElements::PlyElements(const std::filesystem::path& file, bool salvage)
    : input_(file),
      salvage_(salvage),
      header_(read_ply_header(input_)),
      at_(header_.data_offset),
      cursor_(input_, header_.data_offset, header_.data_line) {}

void PlyElements::move_to(const TextPlace& place) {
  at_ = place.offset;
  cursor_.move_to(place.offset, place.line);
}

std::uint64_t PlyElements::least_bytes(const PlyElement& element) const {
  return ascii() ? 2 * element.properties.size() : element.least_bytes();
}

void PlyElements::check_fits(const PlyElement& element) const {
  check_count_fits(file(), fmt::format("line {}", element.line), element.name.c_str(), element.count,
                   least_bytes(element), rest() + (ascii() ? 1 : 0), element.name == "vertex");
}

void PlyElements::read(const PlyElement& element, std::uint64_t row) {
  places_.resize(element.properties.size());
  if (ascii())
    read_line(element, row);
  else
    find_places(element, row);
}

double PlyElements::number(const PlyElement& element, std::size_t i) {
  if (ascii()) return values_[places_[i]];
  const PlyProperty& property = element.properties[i];
  const ScalarType type = property.list ? property.count_type : property.type;
  return load_scalar(input_.at(places_[i], size_of(type)), type, swapped());
}

void PlyElements::skip(const PlyElement& element) {
  if (element.properties.empty()) return;
  if (!ascii() && !element.has_lists()) {
    at_ += element.count * element.least_bytes();
    return;
  }
  for (std::uint64_t row = 0; row < element.count; ++row) read(element, row);
}

// Reads an ascii record into values_; places_[i] is where property i stands in it.
void PlyElements::read_line(const PlyElement& element, std::uint64_t row) {
  cursor_.skip_blank_lines();
  if (cursor_.at_end())
    fail_input(
        "{}: line {}: expected {} records of element {}, found {}; the file is cut short: copy or export "
        "it again, {}",
        file(), cursor_.line(), element.count, element.name, row, kSalvageRemedy);
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
            file(), line, in_quotes(element.properties[i].name), element.name, count);
      expected += static_cast<std::size_t>(count);
    }
    ++expected;
  }
  if (values_.size() != expected)
    fail_input("{}: line {}: expected {} values as the properties of {} say, found {}; correct that line",
               file(), line, expected, element.name, values_.size());
}

// Steps over a binary record; places_[i] is where property i stands in the file.
void PlyElements::find_places(const PlyElement& element, std::uint64_t row) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    places_[i] = at_;
    std::uint64_t count = 1;
    if (property.list) {
      need(1, size_of(property.count_type), element, row);
      const double value =
          load_scalar(input_.at(at_, size_of(property.count_type)), property.count_type, swapped());
      if (value < 0)
        fail_input("{}: byte {}: expected the count of list {} of {} {}, found {}; the file is damaged",
                   file(), at_, in_quotes(property.name), element.name, row, value);
      at_ += size_of(property.count_type);
      count = value < kTwoTo64 ? static_cast<std::uint64_t>(value) : ~std::uint64_t{0};
    }
    need(count, size_of(property.type), element, row);
    at_ += count * size_of(property.type);
  }
}

void PlyElements::need(std::uint64_t count, std::uint64_t size, const PlyElement& element,
                       std::uint64_t row) const {
  if (count > rest() / size)
    fail_input(
        "{}: byte {}: expected {} values of {} bytes for {} {} of {}, found {} bytes; the file is cut "
        "short: copy or export it again, {}",
        file(), at_, count, size, element.name, row, element.count, rest(), kSalvageRemedy);
}

std::vector<std::string> PlyElements::notes_of_rest(bool commas) {
  if (ascii()) return notes_of_text_rest(commas);
  if (at_end()) return {};
  const PlyElement& last = header_.elements.back();
  check_not_sent_as_text(input_, header_.data_offset);
  if (last.name == "vertex" && !last.has_lists() && !salvage_ && rest() >= last.least_bytes() &&
      !input_.only_zeros_from(at_))
    fail_input(
        "{}: byte {}: expected the end of the file after {} vertices, found {} more bytes, room for {} "
        "vertices; correct \"element vertex\" in the header, {}",
        file(), at_, last.count, rest(), rest() / last.least_bytes(), kSalvageRemedy);
  return {fmt::format("byte {}: {} bytes after the last record are ignored", at_, rest())};
}

std::vector<std::string> PlyElements::notes_of_text_rest(bool commas) {
  std::vector<std::string> notes;
  cursor_.skip_blank_lines();
  if (commas || cursor_.commas_seen())
    notes.emplace_back("values are separated by commas, which PLY does not provide for");
  if (at_end()) return notes;
  const PlyElement& last = header_.elements.back();
  const std::uint64_t line = cursor_.line(), bytes = rest();
  if (last.name == "vertex" && !last.has_lists() && !salvage_ &&
      cursor_.next_line_is_numbers(last.properties.size()))
    fail_input(
        "{}: line {}: expected the end of the file after {} vertices, found another vertex; correct "
        "\"element vertex\" in the header, {}",
        file(), line, last.count, kSalvageRemedy);
  notes.push_back(fmt::format("line {}: {} bytes after the last record are ignored", line, bytes));
  return notes;
}

}  // namespace hybrid::io
