#pragma once
#include <vector>

#include "stages/registration/automatic_scene.hpp"
#include "stages/registration/icp_pairs.hpp"

namespace hybrid::stages {

struct TileFit {
  Pose world_from_scan;
  int iterations = 0;
  // Least resistance of the tiles that hold the pose, as a share of what they would resist facing it all
  // (icp_step.hpp's kDeterminedShare has the scale); the direction it leaves open, in words, when too small.
  double least_share = 0;
  Vec3 weakest = Vec3::Zero();  // translation the tiles resist least, unit, world
};

// A tile and the face it lies on under some pose.
struct TilePair {
  const FaceShape* face = nullptr;  // none within reach
  Vec3 centroid = Vec3::Zero();     // of the tile, world
  double height_m = 0;              // of the centroid over the face's plane
  double rms_m = 0;                 // of the tile's samples over it
};

// Per tile: the closest face within `reach_m` whose normal is within 45 degrees of the tile's. `last`: the
// pairs of a pose nearby, which are quicker than nothing to start from.
std::vector<TilePair> find_tile_pairs(const ScanEvidence& scan, const ModelShapes& model, const Pose& pose,
                                      double reach_m, const std::vector<TilePair>& last = {});

// The same with the face given.
TilePair pair_of(const PlaneTile& tile, const FaceShape& face, const Pose& pose);

// Adds `factor` times a tile's area to the normal equations of the plane step about `pivot` (world): exact
// over the tile's samples. Error and inlier sums are the caller's.
void add_tile(const PlaneTile& tile, const TilePair& pair, const Pose& pose, const Vec3& pivot, double factor,
              PlaneSums& sums);

// Point-to-plane ICP whose normal equations are sums over the tiles' moments, exact over all samples
// (FINDINGS.md: 100 of 100 starts from 1 m and 20 degrees): closest compatible face per tile, Tukey weights
// per tile on its rms height with a scale that at most halves per iteration.
TileFit fit_tiles(const ScanEvidence& scan, const ModelShapes& model, const Pose& start,
                  int max_iterations = 30);

}  // namespace hybrid::stages
