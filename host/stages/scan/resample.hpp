#pragma once
#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"
#include "stages/scan/grid_layout.hpp"

namespace hybrid::stages {

// A gap is interpolated when it is short and the ranges on both sides differ by no more than
// jump_m + (jump_slope + jump_factor * s) * arc: arc = smaller range * angle across the gap, s = the smaller
// of the slopes along the column just above and just below it.
struct ResampleOptions {
  double min_range_m = 0;  // nearer returns (the scanner's own body, its tripod) go to `extra`
  double max_gap = 3;      // rows between adjacent samples
  double jump_m = 0.02;    // about what noise and roughness do
  double jump_slope = 0.25;
  double jump_factor = 1.5;
  int tile = 1024;  // samples per tile side on the device
};
const std::vector<OptionRow<ResampleOptions>>& resample_option_table();

// METHOD 1 (paper 2.1): columns recovered from acquisition order (or from the input's own grid), each sorted
// by elevation; a node takes the nearest measured sample within half a step, else a linear interpolation in
// range between adjacent samples of the same column where no depth jump lies between them. Kernel: resample.
// Every return of the scan is either the `source` of one node, in `extra` or in `duplicates`. Organised scans
// keep their grid (organised_grid.hpp; `layout` tells how it lies). Throws ErrorKind::input when the scan has
// no return or no column structure can be found.
RangeImage resample_scan(device::Queue& queue, const Scan& scan, const ResampleOptions& options = {},
                         GridLayout* layout = nullptr);

}  // namespace hybrid::stages
