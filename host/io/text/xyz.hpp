#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// Texts of points as CloudCompare, PDAL (writers.text) and others write them, .xyz .asc .csv .txt: a line of
// numbers for each point, separated by blanks, tabs, commas or semicolons; before them lines that begin with
// # or //, a line with the columns' names (x y z, intensity, red green blue, in any case and order and with
// any others beside them), and a count, may stand. Without names: x y z, x y z intensity, x y z r g b, or
// both in either order (whole numbers to 255 are colours); of more columns x y z alone. Metres, no grid, no
// scanner: see METHOD 1 for what the points must be to become a range image. Throws ErrorKind::input naming
// file and line.
std::vector<ScanEntry> list_xyz(const std::filesystem::path& file, const ReadOptions& options = {});
// Parsed on all threads; in salvage lines that are no points are no-returns.
Scan read_xyz(const std::filesystem::path& file, const ScanEntry& entry);
// The same in blocks; null in salvage.
std::unique_ptr<ScanStream> stream_xyz(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
