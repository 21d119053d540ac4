#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// PCD 0.7: ascii, binary, binary_compressed; any field order and types. Used: x y z, intensity, rgb or rgba
// (packed) or red green blue; names in any case; other fields are listed in Scan::notes. HEIGHT > 1 is an
// organised scan, row by row. Throws ErrorKind::input naming file, line or byte.
//
// VIEWPOINT, unless it is the identity, becomes world_from_scan, and the points are taken to be in the
// scanner's frame. The format leaves that open, and programs differ: pcl_viewer, pcl_transform_from_viewpoint
// and CloudCompare's writer read it so; PCL's normal estimation takes the points to be in the frame the
// viewpoint is given in. The choice is told in Scan::notes.
Scan read_pcd(const std::filesystem::path& file, const ReadOptions& options = {});
// The same in blocks; null in salvage, of points beyond 1 MiB each, and of compressed files where
// scratch_folder() has no room for them.
std::unique_ptr<ScanStream> stream_pcd(const std::filesystem::path& file, const ScanEntry& entry);
// Its one scan, by the header alone.
std::vector<ScanEntry> list_pcd(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace hybrid::io
