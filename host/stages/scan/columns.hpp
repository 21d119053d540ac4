#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::stages {

// The columns of a scan whose file lists samples only, and the regular rows laid over them (METHOD 1).
struct ScanColumns {
  // Column c, by descending elevation (ties: lower index first): samples[begin[c] .. begin[c + 1]).
  std::vector<std::uint32_t> samples;  // indices of the scan's returns, each exactly once
  std::vector<float> row_position;     // of samples[k]: (top - elevation) / step; row r is at position r
  std::vector<std::size_t> begin;      // one more than columns
  std::vector<double> azimuth_rad;     // per column, increasing; not always evenly spaced
  int rows = 0;
  double top_elevation_rad = 0;   // of row 0
  double elevation_step_rad = 0;  // > 0
  bool wraps = false;             // a full turn
  std::size_t sweeps = 0;         // found in the input; those at one azimuth share a column

  int count() const { return static_cast<int>(azimuth_rad.size()); }
};

// Finds the sweeps (from acquisition order, else from clusters of azimuth), lets those closer than half a
// column share one, adds empty columns where the scan has gaps (the widest gap, when over three columns,
// stays open and the grid begins after it), and finds the elevation step and the rows' common phase from the
// samples. A cloud without column structure whose scanner's position was given (Scan::scanner_is_known) gets
// an even grid whose step is its samples' own (scattered.hpp). Throws ErrorKind::input when there is no
// return or no column structure.
ScanColumns recover_columns(const Scan& scan);

// Throws ErrorKind::input: there is no return in what was looked at.
[[noreturn]] void fail_without_returns(const std::string& where);

}  // namespace hybrid::stages
