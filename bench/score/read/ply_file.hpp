#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace score {

struct PlyContent {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// A binary little-endian PLY: x y z of the element `vertex`, and of the element `face`, if there is one, its
// list of three vertex indices; other properties are passed over. Throws InputError.
PlyContent read_ply(const std::filesystem::path& file);

}  // namespace score
