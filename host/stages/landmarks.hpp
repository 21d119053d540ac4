#pragma once
#include <string>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"

namespace hybrid::stages {

struct LandmarkPair {
  std::string name;  // for messages: "landmark 2"
  Vec3 point_in_scan;
  Vec3 point_in_model;
  bool snap = true;  // take the nearest model vertex within the tolerance; false = a control point
};

struct LandmarkOptions {
  double snap_tolerance_m = 0.1;  // a pick farther from every vertex is an error that names it
  bool free_scale = false;
};

struct LandmarkFit {
  Pose world_from_scan;
  double rms_m = 0;
  std::vector<double> residual_m;  // per pick, in the world
  std::vector<double>
      leave_one_out_m;  // per pick: its residual under the fit of the others; empty with 3 picks
};

// METHOD 5 (paper 2.2, Horn 1987): unit quaternion of the largest eigenvalue, RMS-ratio scale (or 1). Throws
// ErrorKind::input: fewer than 3 pairs, coincident or collinear picks (which), a pick too far from any
// vertex, non-finite coordinates.
LandmarkFit fit_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                          const LandmarkOptions& options = {});

// Horn's closed form on given weighted pairs (weights may be empty = 1). Pairs must be neither fewer than 3
// nor collinear.
Pose horn(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const std::vector<double>& weights,
          bool free_scale);

}  // namespace hybrid::stages
