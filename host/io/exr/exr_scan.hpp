#pragma once
#include <filesystem>
#include <optional>

#include "geometry/scan.hpp"
#include "io/grid_scan.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// An OpenEXR range image as a scan, from this program (range.exr) or another: one flat part, in tiles of at
// most 1024 pixels a side or in scan lines, any lossless compression that the library knows. Sample i is
// pixel i, row by row from the top left of the data window; this index is what `source` means in all that is
// made of the scan (the file's own `source` is not used).
//
// Channels: x y z (float, metres, scan frame), or range (float, metres) with angle tables, from which the
// points follow; where both are there, x y z are the measurement. Optional: mask (0 empty, 1 measured, 2
// interpolated; without it every finite point but the origin is measured), intensity, R G B (half or float,
// linear light). Attributes, all optional with x y z: see range_exr_header.hpp.
//
// Only measured nodes are samples; the others are no-returns. Where the tables run as a range image's do
// (elevation down, azimuth up), they and the interpolated nodes are kept in Scan::range_grid, and
// hybrid:extra_samples of them are read from extra.ply beside the file: a range.exr fed in again then gives
// what the scan gave from which it was made. Else the grid is found from the points.
//
// Reads bands of 256 rows: needs the Scan (12 to 19 bytes per node) and about 70 bytes per node of a band.
// Throws ErrorKind::input naming file, channel or attribute, what was expected and found, and the remedy; a
// checksum over the content, where this program wrote one, finds what the compression does not. In salvage
// tiles or lines that cannot be read are no-returns, and notes say where and what share.
Scan read_exr_scan(const std::filesystem::path& file, const ReadOptions& options = {});
// The same as an image, nodes put where stages::arrange_grid() puts the samples, without a list of them:
// where the file has its tables and no samples beside the grid, and there is nothing to tell of it but notes.
std::optional<GridScan> read_exr_grid(const std::filesystem::path& file);
// Its one scan, by the header: nodes and samples beside the grid.
ScanEntry list_exr_scan(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace hybrid::io
