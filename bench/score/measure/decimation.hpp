#pragma once
#include <map>

#include "score/read/scan_result.hpp"
#include "score/read/scene_truth.hpp"

namespace score {

// What was thrown away, and how far the true surface there is from what stands for it: the polygon of the
// supercluster that the sample's label names. The true point lies on the sample's own ray at the range
// without noise.
struct DecimationScore {
  std::int64_t input_samples = 0;  // those that no node of the grid took are always kept
  std::int64_t discarded = 0;
  std::int64_t without_polygon = 0;  // discarded, and no supercluster stands for them
  double largest_mm = 0, percentile_999_mm = 0;
};

// Throws InputError when detail.ply's points are not samples of range.exr.
DecimationScore score_decimation(const LabelledGrid& grid, const std::map<std::uint32_t, ResultPlane>& planes,
                                 const std::vector<Eigen::Vector3f>& kept, const TrueSamples& truth,
                                 const std::string& name);

}  // namespace score
