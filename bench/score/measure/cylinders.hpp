#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "score/read/scan_result.hpp"
#include "score/read/scene_truth.hpp"

namespace score {

// Columns that a scan shows and cylinders that its results have of them.
struct CylinderScore {
  int shown = 0;                      // true upright columns of as many samples as a plane needs to count
  int found = 0;                      // of these, with a cylinder whose axis stays in the middle of their box
  int invented = 0;                   // cylinders in no column's middle, nor in another turned thing's
  std::optional<double> axis_off_mm;  // median of the found, at the end that is farther off
};

inline constexpr double kAxisOff_m = 0.03;  // from the middle of the true box, at either end

// `cylinders` in the scan's frame; samples within a box, 5 mm wider, count as the thing's.
CylinderScore score_cylinders(const LabelledGrid& grid, const TrueSamples& samples,
                              const std::vector<TrueSolid>& solids, const Similarity& world_from_scan,
                              const std::vector<ResultCylinder>& cylinders, std::int64_t min_samples);

}  // namespace score
