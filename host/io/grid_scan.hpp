#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// An organised scan whose samples were put into their nodes while they were decoded: a list of them, the half
// of what reading costs, never was. stages::orient_grid() makes its range image.
struct GridScan {
  Scan scan;                                          // all but its samples
  RangeImage image;                                   // x y z, range, mask, source, intensity and colour
  bool has_tables = false;                            // and the angle tables, which else are still zero
  bool rows_reversed = false, cols_reversed = false;  // the image's first row, or column, is the file's last
  std::uint64_t samples = 0;                          // records
  std::uint64_t returns = 0;                          // with finite coordinates
};

// As read_scan(), of formats and scans of which every return has a node of its own (E57 with row and column
// indices, coordinates that are not large, no damage; range images with their angle tables); nothing where
// that is not so: then read_scan() does.
std::optional<GridScan> read_grid_scan(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
