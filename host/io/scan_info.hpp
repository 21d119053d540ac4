#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// What a scan holds, for `hybrid info`. Extents are in the scan frame (Scan::origin added), ranges from its
// origin, both over returns only; zero without any.
struct ScanInfo {
  std::string format;  // E57, PCD, PLY, PTX, PTS, LAS or EXR
  std::string name;
  std::uint64_t points = 0;          // samples of the file; of a range image: grid nodes
  std::uint64_t returns = 0;         // finite and not at the scan frame's origin
  int grid_rows = 0, grid_cols = 0;  // 0: not organised
  Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();
  double min_range_m = 0, max_range_m = 0;
  bool has_intensity = false, has_colour = false;
  std::optional<Pose> world_from_scan;
  std::string structure;  // of the file's records: "LAS 1.2, point format 3, ..."
  std::string unit;       // of its coordinates, where format or file say; extents and ranges are in it
  std::string crs;        // WKT or "EPSG:27700"
  std::string problem;    // why the scan cannot be read, or ""; then only name, points and grid are known
  std::vector<std::string> notes;
};

ScanInfo describe(const ScanStream& scan, const std::string& format);

// Of every scan in a file, in blocks where the format is streamed (stream_scan()). Throws as read_scan does;
// of several scans, only when none can be read.
std::vector<ScanInfo> read_scan_info(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace hybrid::io
