#pragma once
#include <vector>

#include "stages/registration/automatic_rotations.hpp"
#include "stages/registration/automatic_scene.hpp"

namespace hybrid::stages {

// A pose worth a closer look.
struct PoseGuess {
  Pose world_from_scan;
  double score = 0;  // of the step that made it
};

// Translations for one rotation: every scan plane along a model plane votes for an offset along that plane's
// normal; the peaks along three independent directions combine. Score: area of the tiles that lie within
// 30 cm of a compatible face. Best first, at most `most`. `scale` of the poses: world metres per scan metre.
std::vector<PoseGuess> guess_offsets(const ScanEvidence& scan, const ModelShapes& model,
                                     const Eigen::Quaterniond& rotation, double scale, std::size_t most);

// Whether two poses put the scan in the same place: its planes' rms shift below `distance_m`.
bool same_place(const ScanEvidence& scan, const Pose& a, const Pose& b, double distance_m);

}  // namespace hybrid::stages
