#pragma once
#include <vector>

#include "score/geometry.hpp"

namespace score {

struct PosePair {
  Similarity found, truth;
};

// What poses are off among themselves: after the one rigid motion of all of them together that brings them
// nearest to the truth (METHOD: joint, scan to scan).
struct CommonFit {
  std::size_t scans = 0;
  double place_rms_mm = 0, rotation_rms_deg = 0;          // of the scanners
  double place_largest_mm = 0, rotation_largest_deg = 0;  // the worst scan's
  double moved_mm = 0, moved_deg = 0;                     // the motion itself, at the scanners' centre
};

// Least squares over the scanners and the ends of their axes 5 m off (what a scan measures lies about there).
// At least two.
CommonFit fit_in_common(const std::vector<PosePair>& poses);

}  // namespace score
