#pragma once
#include <filesystem>
#include <vector>

#include "score/geometry.hpp"

namespace score {

// An organised cloud whose `intensity` is the number of each point's plane, as SynPEB publishes them.
struct LabelledPcd {
  int width = 0, height = 0;
  std::vector<Vec3> points;  // row by row
  std::vector<std::uint32_t> label;
};

// ASCII or uncompressed binary. Throws InputError.
LabelledPcd read_labelled_pcd(const std::filesystem::path& file);

}  // namespace score
