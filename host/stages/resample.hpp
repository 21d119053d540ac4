#pragma once
#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"

namespace hybrid::stages {

struct ResampleOptions {
  int tile = 1024;  // samples per tile side on the device
};
const std::vector<OptionRow<ResampleOptions>>& resample_option_table();

// METHOD 1 (paper 2.1): columns recovered from acquisition order (or from the input's own grid), each sorted
// by elevation; a node takes the nearest measured sample within half a step, else a linear interpolation in
// range between adjacent samples of the same column where no depth jump lies between them. Kernel: resample.
// Throws ErrorKind::input when the scan has no return or no column structure can be found.
RangeImage resample_scan(device::Queue& queue, const Scan& scan, const ResampleOptions& options = {});

}  // namespace hybrid::stages
