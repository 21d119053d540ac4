#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/input_file.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {

struct PlyProperty {
  std::string name;  // lower case
  ScalarType type = ScalarType::f32;
  bool list = false;  // a count of type count_type, then that many values
  ScalarType count_type = ScalarType::u8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::uint64_t line = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  std::uint64_t least_bytes() const;  // of a binary record, lists being empty
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::uint64_t data_offset = 0;  // in the file
  std::uint64_t data_line = 0;
};

// The header of PLY 1.0 with its end_header line. Throws ErrorKind::input naming the line.
PlyHeader read_ply_header(InputFile& file);

}  // namespace hybrid::io
