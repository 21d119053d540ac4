#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "geometry/scan.hpp"
#include "io/input_file.hpp"
#include "io/pcd/pcd_header.hpp"
#include "io/scan_builder.hpp"
#include "io/text/text_cursor.hpp"
#include "io/text/text_samples.hpp"

namespace hybrid::io {

// The fields that become a Scan.
struct PcdUsedFields {
  const PcdField *x = nullptr, *y = nullptr, *z = nullptr, *intensity = nullptr;
  const PcdField* packed = nullptr;  // 0xAARRGGBB as uint, int or float bits
  const PcdField *red = nullptr, *green = nullptr, *blue = nullptr;

  bool three_colours() const { return !packed && red && green && blue; }
  ColourKind colour() const {
    if (packed) return ColourKind::byte;
    return three_colours() ? colour_kind(red->type) : ColourKind::none;
  }
};

// Of a line's numbers.
ScanSample pcd_sample_of_row(const PcdUsedFields& used, const double* row);

// One sample: number(field) is its value, bits(field) the 32 bits of a packed colour.
template <typename Number, typename Bits>
ScanSample make_pcd_sample(const PcdUsedFields& used, const Number& number, const Bits& bits) {
  ScanSample sample{number(*used.x), number(*used.y), number(*used.z), 0, {}};
  if (used.intensity) sample.intensity = number(*used.intensity);
  if (used.packed) {
    const std::uint32_t colour = bits(*used.packed);
    sample.rgb = {static_cast<double>((colour >> 16) & 255), static_cast<double>((colour >> 8) & 255),
                  static_cast<double>(colour & 255)};
  } else if (used.three_colours()) {
    sample.rgb = {number(*used.red), number(*used.green), number(*used.blue)};
  }
  return sample;
}

// Of a field that lies in memory at(field).
template <typename At>
ScanSample pcd_sample_in_memory(const PcdUsedFields& used, const At& at) {
  const auto number = [&](const PcdField& field) { return load_scalar(at(field), field.type, false); };
  const auto bits = [&](const PcdField& field) { return load_as<std::uint32_t>(at(field), false); };
  return make_pcd_sample(used, number, bits);
}

// Of a binary point.
struct FromPcdRecord {
  const PcdUsedFields& used;

  ScanSample operator()(const char* record) const {
    return pcd_sample_in_memory(used, [&](const PcdField& field) { return record + field.byte_offset; });
  }
};

// Where a PCD file's points lie, and what stands behind them.
struct PcdFile {
  PcdFile(const std::filesystem::path& file, bool for_salvage);
  PcdFile(const PcdFile&) = delete;
  PcdFile& operator=(const PcdFile&) = delete;

  std::vector<std::string> notes() const;

  bool grid() const { return header.width > 1 && header.height > 1; }
  // Single precision holds what was written in it.
  bool rounds() const;

  // Where a byte of the data lies in the file.
  std::string byte(std::uint64_t offset) const { return fmt::format("byte {}", data + offset); }

  // Throws where the rest of the file cannot hold the points; in salvage there are no more of them.
  void bound_points();

  struct Sizes {
    std::uint64_t compressed, expanded;  // bytes
  };
  // Of binary_compressed data, which lie behind them. Throws where they and the header cannot all be true; in
  // salvage what is in the file counts.
  Sizes compressed_sizes();
  [[noreturn]] void fail_compressed(const std::string& damage) const;

  void read_line(TextCursor& at, std::span<double> values, std::uint64_t done) const;

  // What stands behind the last point, as a note or none. A further point means that the header is wrong; of
  // text: `place` is behind the last point, and whether commas were seen.
  std::vector<std::string> notes_of_rest(const TextPlace& place, bool commas);

  // PCL's writer fills the last page with zeros, which are worth no note.
  std::vector<std::string> notes_of_rest(std::uint64_t used_bytes);

  void set_grid_and_pose(Scan& scan) const;

  InputFile input;
  const std::string& name;
  bool salvage;
  PcdHeader header;
  std::uint64_t data, data_bytes;  // where the data begins, and how much there is
  PcdUsedFields used;
  std::string unused;
};

}  // namespace hybrid::io
