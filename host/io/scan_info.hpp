#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::io {

// What a scan holds, for `hybrid info`. Extents are in the scan frame (Scan::origin added), ranges from its
// origin, both over returns only; zero without any.
struct ScanInfo {
  std::string format;  // E57, PCD, PLY, PTX or EXR
  std::string name;
  std::uint64_t points = 0;          // samples of the file; of a range image: grid nodes
  std::uint64_t returns = 0;         // finite and not at the scan frame's origin
  int grid_rows = 0, grid_cols = 0;  // 0: not organised
  Vec3 min_m = Vec3::Zero(), max_m = Vec3::Zero();
  double min_range_m = 0, max_range_m = 0;
  bool has_intensity = false, has_colour = false;
  std::optional<Pose> world_from_scan;
  std::vector<std::string> notes;
};

ScanInfo describe(const Scan& scan, const std::string& format);

// Of every scan in a file, which is read whole: .e57 .pcd .ply .ptx and range images (.exr, measured
// samples). Throws as read_scans and read_range_exr do.
std::vector<ScanInfo> read_scan_info(const std::filesystem::path& file);

}  // namespace hybrid::io
