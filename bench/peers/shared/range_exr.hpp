#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace hybrid::peers {

// What the peers see of a range.exr: the organised grid (row 0 = highest elevation, row-major), points in the
// scan frame in metres, NaN where the mask is 0. No code of host/: a peer gets no help from our readers.
struct RangeScan {
  int rows = 0, cols = 0;
  std::vector<float> x, y, z;
  std::vector<std::uint8_t> mask;  // 0 empty, 1 measured, 2 interpolated within a column

  std::size_t count() const { return x.size(); }
  std::size_t measured() const;
};

// Throws std::runtime_error naming the file, what was expected and what was found.
RangeScan read_range_exr(const std::filesystem::path& file);

// The scan without the nodes that the resampler interpolated: the scanner's own holes.
RangeScan with_holes(RangeScan scan);

// Every gap of at most `longest` empty nodes within a row is bridged linearly when the range differs by less
// than 5 % across it: what a user of an integral-image method does to a scan with dropouts.
RangeScan with_holes_filled(RangeScan scan, int longest = 4);

}  // namespace hybrid::peers
