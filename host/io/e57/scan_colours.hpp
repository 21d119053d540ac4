#pragma once
#include <array>
#include <cstdint>

#include "io/e57/e57_model.hpp"
#include "io/e57/record_reader.hpp"
#include "io/e57/scan_columns.hpp"

namespace hybrid::io {

// Colours become bytes by the file's colour limits. Without them fields of 256 values are bytes; else the
// largest value of the scan tells, as for other formats: words often hold bytes, and reals are 0..1 or
// 0..255.
class ColourScale {
 public:
  ColourScale(const E57RecordReader& reader, const E57Scan& scan, const ScanColumns& columns);

  std::uint8_t byte(std::size_t channel, double value) const {
    const double scaled = (value - low_[channel]) * factor_[channel] + 0.5;
    return static_cast<std::uint8_t>(scaled > 0 ? (scaled < 255 ? scaled : 255.0) : 0.0);  // NaN: 0
  }

 private:
  std::array<double, 3> low_{}, factor_{};
};

}  // namespace hybrid::io
