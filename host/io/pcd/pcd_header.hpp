#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/input_file.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {

struct PcdField {
  std::string name;  // lower case
  ScalarType type = ScalarType::f32;
  std::uint64_t count = 1;
  std::uint64_t byte_offset = 0;   // within a binary point
  std::uint64_t value_offset = 0;  // within an ascii line
};

enum class PcdData { ascii, binary, binary_compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  // tx ty tz qw qx qy qz
  PcdData data = PcdData::ascii;
  std::uint64_t point_bytes = 0;   // of a binary point
  std::uint64_t point_values = 0;  // of an ascii line
  std::uint64_t data_offset = 0;   // in the file
  std::uint64_t data_line = 0;
  std::vector<std::string> notes;
};

// The header of PCD 0.5 to 0.7 up to and with its DATA line. Throws ErrorKind::input naming the line: an
// unknown keyword or type, missing FIELDS, SIZE, TYPE, WIDTH or DATA, WIDTH x HEIGHT other than POINTS, a
// VIEWPOINT that is no pose. In salvage the last two become notes: POINTS are taken, as not organised, and no
// pose.
PcdHeader read_pcd_header(InputFile& file, bool salvage = false);

}  // namespace hybrid::io
