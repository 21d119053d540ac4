#pragma once
#include <filesystem>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::io {

// Leica PTX: one or more scans, 4 or 7 columns (x y z intensity [r g b]); points stay in the scanner's frame
// and the 4x4 becomes world_from_scan; "0 0 0" lines are no-returns (NaN points). grid_rows/cols set.
std::vector<Scan> read_ptx(const std::filesystem::path& file);

}  // namespace hybrid::io
