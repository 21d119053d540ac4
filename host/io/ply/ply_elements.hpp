#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/input_file.hpp"
#include "io/ply/ply_header.hpp"
#include "io/scan_builder.hpp"
#include "io/text/number_rows.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {

// The vertex properties that become a Scan, by their place in the element. Throws ErrorKind::input without
// x, y and z, and for one that is there twice.
class PlyVertex {
 public:
  PlyVertex(const std::string& file, const PlyElement& vertex);

  bool intensity() const { return intensity_.has_value(); }
  ColourKind colour() const { return colour_; }
  bool rounds() const { return rounds_; }                // float does not hold the coordinates
  const std::string& unused() const { return unused_; }  // "" or names

  // number(i) is the value of property i.
  template <typename Number>
  ScanSample sample(const Number& number) const {
    ScanSample sample{number(*x_), number(*y_), number(*z_), 0, {}};
    if (intensity_) sample.intensity = number(*intensity_);
    if (colour_ != ColourKind::none) sample.rgb = {number(*red_), number(*green_), number(*blue_)};
    return sample;
  }

 private:
  using Index = std::optional<std::size_t>;
  Index x_, y_, z_, intensity_, red_, green_, blue_;
  ColourKind colour_ = ColourKind::none;
  bool rounds_ = false;
  std::string unused_;
};

// Goes through a PLY file's elements, record by record, in either form.
class PlyElements {
 public:
  PlyElements(const std::filesystem::path& file, bool salvage);

  InputFile& input() { return input_; }
  const std::string& file() const { return input_.name(); }
  const PlyHeader& header() const { return header_; }
  bool ascii() const { return header_.format == PlyFormat::ascii; }
  bool swapped() const { return header_.format == PlyFormat::big_endian; }

  // Where the next record is, of text its line.
  TextPlace place() const { return ascii() ? TextPlace{cursor_.offset(), cursor_.line()} : TextPlace{at_}; }
  void move_to(const TextPlace& place);
  void next_line() { cursor_.next_line(); }
  std::uint64_t rest() const { return ascii() ? cursor_.remaining() : input_.size() - at_; }
  bool at_end() const { return rest() == 0; }
  void skip_blank_lines() { cursor_.skip_blank_lines(); }
  std::uint64_t least_bytes(const PlyElement& element) const;  // of a record
  // Throws where the rest of the file cannot hold the element.
  void check_fits(const PlyElement& element) const;

  // Reads a record: `row` of the element. Its numbers in text, all of them; else number() looks into the
  // file.
  void read(const PlyElement& element, std::uint64_t row);
  const std::vector<double>& numbers() const { return values_; }
  // Of the record read, the value of property i, of a list its count.
  double number(const PlyElement& element, std::size_t i);
  void skip(const PlyElement& element);

  // What stands behind the last element: a note of it or none. A further vertex means that the header is
  // wrong: throws, but not in salvage. `commas`: they were seen between numbers.
  std::vector<std::string> notes_of_rest(bool commas);

 private:
  void read_line(const PlyElement& element, std::uint64_t row);
  void find_places(const PlyElement& element, std::uint64_t row);
  void need(std::uint64_t count, std::uint64_t size, const PlyElement& element, std::uint64_t row) const;
  std::vector<std::string> notes_of_text_rest(bool commas);

  InputFile input_;
  bool salvage_;
  PlyHeader header_;
  std::uint64_t at_;   // binary: in the file
  TextCursor cursor_;  // ascii
  std::vector<double> values_;
  std::vector<std::uint64_t> places_;  // of property i, in the file or in values_
};

}  // namespace hybrid::io
