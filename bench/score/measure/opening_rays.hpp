#pragma once
#include <cstdint>
#include <vector>

#include "score/measure/openings.hpp"
#include "score/read/scan_result.hpp"

namespace score {

// Measured lines of sight that cross an opening less than 70 degrees off its normal, counted against the true
// pose, whatever a result makes of them.
inline constexpr double kSteepestDeg = 70;

// Adds one scan's to OpeningScore::One::rays and collects the spacing of its samples on the opening.
void count_opening_rays(const LabelledGrid& grid, const Similarity& world_from_scan,
                        const std::vector<TrueOpening>& truth, OpeningScore& score);

}  // namespace score
