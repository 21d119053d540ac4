#pragma once
#include <vector>

#include "stages/registration/joint_poses.hpp"

namespace hybrid::stages {

// A tile of one scan that lies on a plane of another.
struct JointMatch {
  std::size_t from = 0, to = 0;  // scans: whose tile, whose plane
  std::size_t tile = 0;
  const FaceShape* face = nullptr;  // of `to`, scan frame
  double rms_m = 0;                 // of the tile's samples over the plane
  double weight = 0;                // area times robust weight
};

// All matches between all scans under these poses, in fixed order, weights not set.
std::vector<JointMatch> find_matches(const std::vector<JointScan>& scans, const std::vector<Pose>& poses,
                                     double reach_m);

// rms of the tile's samples over the plane under these poses.
double rms_of(const JointMatch& match, const std::vector<JointScan>& scans, const std::vector<Pose>& poses);

// Median by area of the matches' rms; 0 without any.
double median_rms(const std::vector<JointMatch>& matches, const std::vector<JointScan>& scans);

// One report per pair of scans that share planes; `matches` are those within the cutoff.
std::vector<PairReport> report_pairs(const std::vector<JointScan>& scans, const std::vector<Pose>& poses,
                                     const std::vector<JointMatch>& matches);

}  // namespace hybrid::stages
