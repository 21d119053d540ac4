#pragma once
#include <filesystem>
#include <vector>

#include "geometry/scan.hpp"

namespace hybrid::io {

// Every scan in a file, chosen by its extension (.e57 .pcd .ply .ptx, in any case). Range images (.exr) are
// not samples but a grid: read_range_exr. Throws ErrorKind::input naming the file, the place (line or byte),
// what was expected, what was found and the remedy. Allocates nothing before the header's counts are checked
// against the file's size.
std::vector<Scan> read_scans(const std::filesystem::path& file);

}  // namespace hybrid::io
