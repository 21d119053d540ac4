#pragma once
#include <array>
#include <filesystem>
#include <vector>

namespace hybrid::peers {

// A sample for registration: x y z, normal (0 0 0 = none) in the scan frame, and the area in m2 it stands
// for.
using PlyPoint = std::array<float, 7>;

// Binary PLY with exactly the properties x y z nx ny nz area; reads only what write_points_ply wrote. Both
// throw std::runtime_error naming the file.
void write_points_ply(const std::filesystem::path& file, const std::vector<PlyPoint>& points);
std::vector<PlyPoint> read_points_ply(const std::filesystem::path& file);

}  // namespace hybrid::peers
