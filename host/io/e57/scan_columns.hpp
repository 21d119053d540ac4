#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/e57/e57_model.hpp"
#include "io/e57/record_reader.hpp"

namespace hybrid::io {

// Which fields of a table a Scan is made of: positions in `fields`.
struct ScanColumns {
  using Slot = std::optional<std::size_t>;

  std::vector<std::size_t> fields;     // indices into the table's, those to read
  bool spherical = false;              // else Cartesian
  std::array<std::size_t, 3> place{};  // x y z, or range azimuth elevation
  Slot invalid;                        // 0: valid
  Slot intensity, intensity_invalid;
  std::optional<std::array<std::size_t, 3>> colour;
  Slot colour_invalid;
  Slot row, column, return_index;
  std::vector<std::string> unused;  // names of the others

  // Throws ErrorKind::input when there are no coordinates. `where` names file and scan.
  static ScanColumns of(const std::string& where, const E57Table& table);
};

// A column's values, scaled integers scaled.
void values_of(const E57Field& field, const E57Records& records, std::size_t slot, std::span<double> to);

// x y z in place of range, azimuth and elevation (from the XY plane), in double.
void to_cartesian(std::span<double> range_x, std::span<double> azimuth_y, std::span<double> elevation_z);

}  // namespace hybrid::io
