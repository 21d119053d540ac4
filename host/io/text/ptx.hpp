#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// Leica PTX: one or more scans, 4 or 7 columns (x y z intensity [r g b]); points stay in the scanner's frame
// and the 4x4 becomes world_from_scan, unless it is the identity; "0 0 0" lines are no-returns (NaN points).
// grid_rows/cols set.
//
// Lists the scans by their headers and by counting lines. A header that is wrong ends the list: of the first
// scan it throws ErrorKind::input, of a later one it becomes that entry's problem. In salvage a scan ends
// where the next one starts, lines that are no points are no-returns, and a grid is cropped to the columns
// that are there; what stands between scans is an entry with a problem.
std::vector<ScanEntry> list_ptx(const std::filesystem::path& file, const ReadOptions& options = {});
// One of them, parsed on all threads. Throws ErrorKind::input naming file and line.
Scan read_ptx(const std::filesystem::path& file, const ScanEntry& entry);
// The same in blocks; null in salvage.
std::unique_ptr<ScanStream> stream_ptx(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
