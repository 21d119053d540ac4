#pragma once
#include "score/read/scan_result.hpp"

namespace score {

struct PoseLimits {
  double deg = 0.5, mm = 50, scale = 0.005;
};

// Against truth after no alignment (METHOD); both in one frame.
struct PoseScore {
  double rotation_deg = 0;
  double translation_mm = 0;  // of the scanner's place
  double scale_error = 0;     // relative
  bool accepted = false;      // else abstained: its errors say how far the guess is, and are no failure
  bool wrong = false;         // accepted, and beyond a limit
};
PoseScore score_pose(const ResultPose& result, const Similarity& truth, const PoseLimits& limits);

}  // namespace score
