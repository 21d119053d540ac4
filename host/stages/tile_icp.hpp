#pragma once
#include "stages/automatic_scene.hpp"

namespace hybrid::stages {

struct TileFit {
  Pose world_from_scan;
  int iterations = 0;
  // Least resistance of the tiles that hold the pose, as a share of what they would resist facing it all
  // (icp_step.hpp's kDeterminedShare has the scale); the direction it leaves open, in words, when too small.
  double least_share = 0;
  Vec3 weakest = Vec3::Zero();  // translation the tiles resist least, unit, world
};

// Point-to-plane ICP whose normal equations are sums over the tiles' moments, exact over all samples
// (FINDINGS.md: 100 of 100 starts from 1 m and 20 degrees): closest compatible face per tile, Tukey weights
// per tile on its rms height with a scale that at most halves per iteration.
TileFit fit_tiles(const ScanEvidence& scan, const ModelShapes& model, const Pose& start,
                  int max_iterations = 30);

}  // namespace hybrid::stages
