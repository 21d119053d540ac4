#pragma once
#include <filesystem>

#include "geometry/scan.hpp"

namespace hybrid::io {

// PCD 0.7: ascii, binary, binary_compressed; any field order and types; VIEWPOINT becomes world_from_scan.
Scan read_pcd(const std::filesystem::path& file);

}  // namespace hybrid::io
