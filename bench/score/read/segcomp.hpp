#pragma once
#include <filesystem>
#include <map>
#include <vector>

#include "score/geometry.hpp"

namespace score {

// SegComp's files (Hoover et al. 1996; ABW and Perceptron images alike): label images are 8-bit Sun
// rasterfiles whose values from 10 on are regions and below 10 shadow, noise and edges.
struct RasterLabels {
  int width = 0, height = 0;
  std::vector<std::uint32_t> label;  // 0 where the file has a value below kFirstRegion
};
inline constexpr std::uint32_t kFirstRegion = 10;

RasterLabels read_rasterfile(const std::filesystem::path& file);  // NAME.gt-seg, NAME.ms-seg

struct RegionAngle {
  std::uint32_t a, b;
  double deg;
};
std::vector<RegionAngle> read_region_angles(const std::filesystem::path& file);        // NAME.gt-ang
std::map<std::uint32_t, Vec3> read_region_normals(const std::filesystem::path& file);  // NAME.ms-nor

}  // namespace score
