#pragma once
#include <optional>
#include <string>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"

namespace hybrid::stages {

struct LandmarkPair {
  std::string name;  // for messages: "landmark 2"
  Vec3 point_in_scan;
  Vec3 point_in_model;
  bool snap = true;     // take the nearest model vertex within the tolerance; false = a control point
  std::string place{};  // for messages: "scan (1.02, 3.30, 0.51)"
};

struct LandmarkOptions {
  double snap_tolerance_m = 0.1;  // a pick farther from every vertex is an error that names it
  bool free_scale = false;
  std::string frame = "scan";  // for messages: what the picks' coordinates are of
};

struct LandmarkFit {
  Pose world_from_scan;
  double rms_m = 0;                // of the picks that were fitted
  std::vector<double> residual_m;  // per pick, in the world
  // Per pick, from the fit of all the others: how far that fit misses the pick, and the rms it has on its own
  // picks. Empty with 3 picks; NaN where the others are collinear.
  std::vector<double> leave_one_out_m;
  std::vector<double> rms_without_m;
  std::optional<std::size_t> left_out{};  // the pick that was not fitted, by check_landmarks() alone
};

// The picks as control points, each on its vertex. Throws ErrorKind::input, naming the pick: non-finite
// coordinates, no vertex within the tolerance.
std::vector<LandmarkPair> snap_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                                         double tolerance_m);

// METHOD 5 (paper 2.2, Horn 1987): unit quaternion of the largest eigenvalue, RMS-ratio scale (or 1). Throws
// ErrorKind::input: fewer than 3 pairs, coincident or collinear picks (which), a pick too far from any
// vertex, non-finite coordinates.
LandmarkFit fit_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                          const LandmarkOptions& options = {});

// The pick whose removal makes the rest agree, if there is one: it misses the fit of the others by more than
// `factor` times what these miss it by (and by more than 1 mm), and without it they agree at least twice as
// well as without any other pick.
std::optional<std::size_t> outlying_pick(const LandmarkFit& fit, double factor = 4);

// Whether the points are so far from any one line that they fix a rotation.
bool fix_rotation(const std::vector<Vec3>& points);

// Root of the mean square of |pose * from - to|.
double rms_of(const Pose& pose, const std::vector<Vec3>& from, const std::vector<Vec3>& to);

// Horn's closed form on given weighted pairs (weights may be empty = 1). Pairs must be neither fewer than 3
// nor collinear.
Pose horn(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const std::vector<double>& weights,
          bool free_scale);

// The rotation of Horn's closed form: cross_covariance(a, b) = sum of from'_a to'_b about the centroids.
Eigen::Quaterniond horn_rotation(const Mat3& cross_covariance);

}  // namespace hybrid::stages
