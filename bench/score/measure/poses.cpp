#include "score/measure/poses.hpp"

#include <cmath>

namespace score {

PoseScore score_pose(const ResultPose& result, const Similarity& truth, const PoseLimits& limits) {
  const Similarity& found = result.world_from_scan;
  PoseScore score;
  score.rotation_deg = rotation_angle_deg(found.rotation * truth.rotation.transpose());
  score.translation_mm = (found.translation - truth.translation).norm() * 1000;
  score.scale_error = found.scale / truth.scale - 1;
  score.accepted = result.accepted;
  const bool within = score.rotation_deg <= limits.deg && score.translation_mm <= limits.mm &&
                      std::abs(score.scale_error) <= limits.scale;
  score.wrong = score.accepted && !within;
  return score;
}

}  // namespace score
