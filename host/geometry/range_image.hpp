#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/vectors.hpp"

namespace hybrid {

enum SampleMask : std::uint8_t { kEmpty = 0, kMeasured = 1, kInterpolated = 2 };
inline constexpr std::uint32_t kNoSource = 0xffffffffu;

// A scan resampled to a grid over spherical angles (METHOD: row 0 = highest elevation, columns by increasing
// azimuth). All per-sample vectors have rows * cols elements, row-major; index(row, col).
struct RangeImage {
  int rows = 0, cols = 0;
  std::vector<double> elevation_rad;  // per row, decreasing
  std::vector<double> azimuth_rad;    // per column, increasing
  bool wraps = false;                 // the last column neighbours the first one (a full turn)

  std::vector<float> range_m;  // NaN where the mask says empty
  std::vector<float> x, y,
      z;  // scan frame, metres; the *measured* point (or the interpolated one); NaN empty
  std::vector<std::uint8_t> mask;                // SampleMask
  std::vector<std::uint32_t> source;             // index into the input's samples; kNoSource unless measured
  std::vector<float> intensity;                  // per sample, or empty
  std::vector<std::array<std::uint8_t, 3>> rgb;  // per sample, or empty
  std::vector<std::uint32_t> extra;  // input samples no node took (collisions): kept, counted, never planar
  std::vector<std::uint32_t> duplicates;  // input samples that repeat a measured node's point bit for bit:
                                          // counted, not kept twice

  std::size_t count() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  // Of an image that wraps the column that a column beyond an end is; else the same. No division: it is asked
  // of every neighbour of every sample.
  int wrapped(int col) const {
    if (!wraps) return col;
    while (col < 0) col += cols;
    while (col >= cols) col -= cols;
    return col;
  }
  Vec3 point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  double elevation_step_rad() const {
    return rows > 1 ? (elevation_rad.front() - elevation_rad.back()) / (rows - 1) : 0;
  }
  double azimuth_step_rad() const {
    return cols > 1 ? (azimuth_rad.back() - azimuth_rad.front()) / (cols - 1) : 0;
  }
  double step_rad() const {  // the larger one
    return std::max(elevation_step_rad(), azimuth_step_rad());
  }
};

// Whether columns at these azimuths (increasing) go all around: no more than three steps are missing.
bool is_full_turn(const std::vector<double>& azimuth_rad);

// An all-empty image of the given extent; angle tables zero.
RangeImage make_range_image(int rows, int cols);

}  // namespace hybrid
