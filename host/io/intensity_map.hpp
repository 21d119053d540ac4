#pragma once
#include <array>
#include <optional>

#include "io/scan_stream.hpp"

namespace hybrid::io {

// Takes a scan's intensities to a format's range. Those that have the same limits, or none and lie within,
// stay; the others are scaled from their limits, or else from the least and greatest there are. In a format
// of whole numbers (`whole`) fractions stay only where they span 255 or more; from 0 to 1 are limits then.
struct IntensityMap {
  double scale = 1, shift = 0;
  std::array<float, 2> from{}, to{};
  bool identity() const { return scale == 1 && shift == 0; }
  double operator()(float value) const { return scale * static_cast<double>(value) + shift; }
};
IntensityMap map_intensity(const ScanStream& scan, const std::optional<std::array<float, 2>>& limits,
                           bool whole = false);

}  // namespace hybrid::io
