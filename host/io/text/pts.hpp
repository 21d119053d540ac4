#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// Leica PTS: x y z, x y z intensity, x y z r g b or x y z intensity r g b, in metres, after a line with their
// count; several counts are several scans, and the one count of a file may be missing. Neither grid nor
// scanner: see METHOD 1 for what the points must be to become a range image. Intensities are whole numbers
// from -2048 to 2047 in Leica's own files.
//
// Lists the scans by their counts and by counting lines; a count that is wrong ends the list, as in PTX. In
// salvage a scan is what stands between two counts, whatever they say, and lines that are no points are
// no-returns.
std::vector<ScanEntry> list_pts(const std::filesystem::path& file, const ReadOptions& options = {});
// One of them, parsed on all threads. Throws ErrorKind::input naming file and line.
Scan read_pts(const std::filesystem::path& file, const ScanEntry& entry);
// The same in blocks; null in salvage.
std::unique_ptr<ScanStream> stream_pts(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
