#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// LAS 1.0 to 1.4, point formats 0 to 10, not compressed: coordinates (relative to Scan::origin when they are
// large, so that scaled integers keep their digits), intensity 0 to 65535, colour; the record of the
// coordinate system is carried. Fields that hold something and are not used are named in Scan::notes. The
// format knows no scanner: see METHOD 1 for what the points must be to become a range image. Throws
// ErrorKind::input naming the byte.
std::vector<ScanEntry> list_las(const std::filesystem::path& file, const ReadOptions& options = {});
Scan read_las(const std::filesystem::path& file, const ScanEntry& entry);
// The same in blocks; null in salvage.
std::unique_ptr<ScanStream> stream_las(const std::filesystem::path& file, const ScanEntry& entry);

}  // namespace hybrid::io
