#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"
#include "stages/registration/icp_pairs.hpp"

namespace hybrid::stages {

// A direction counts as determined when the pairs resist it with at least this share of what they would if
// all of them faced it: 0.01 % of the area on an end wall, or side walls 0.6 degrees from parallel.
inline constexpr double kDeterminedShare = 1e-4;

// How far a step moves: its rotation, and its translation at the pivot.
struct StepSize {
  double angle_rad = 0, distance_m = 0, relative_scale = 0;
};

// Solves the normal equations in the determined directions only, limits the rotation to 0.35 rad, and applies
// the step to the pose about `pivot` (world). `radius_m`, the samples' rms distance from the pivot, makes
// rotations and translations comparable.
StepSize apply_plane_step(const PlaneSums& sums, const Vec3& pivot, double radius_m, bool free_scale,
                          Pose& world_from_scan);

// Takes the pose back to where `start` has it along the directions that these pairs leave open: pairs that
// moved it there and that the robust weights have dropped since do not count. `centre_in_scan` is the pivot.
StepSize return_along_open(const PlaneSums& sums, const Vec3& centre_in_scan, double radius_m,
                           const Pose& start, Pose& world_from_scan);

// Least resistance of the pairs along any direction of movement, as a share of what they would resist facing
// it all (kDeterminedShare has the scale). Needs pairs.
double least_share(const PlaneSums& sums, double radius_m);

// The pose of Horn's closed form on the pairs; with free_scale s = sum r'.R l' / sum |l'|^2 (METHOD 6).
Pose horn_pose(const PointSums& sums, double scale, bool free_scale);

// Of Registration::degenerate.
inline constexpr const char* kFreeToScale = "free to scale";

// Directions the pairs leave open: world, unit.
struct OpenDirections {
  std::vector<Vec3> slides, turns;  // along, about
  bool scale = false;
  std::vector<std::string> in_words() const;  // Registration::degenerate
  std::optional<Vec3> only_slide() const;     // Registration::only_slide
};
OpenDirections degenerate_directions(const PlaneSums& sums, double radius_m, bool free_scale);

// Registration::covariance, when every direction had all of the pairs facing it with this variance (m2).
std::array<double, 36> pose_covariance(const PlaneSums& sums, double variance, const Vec3& pivot,
                                       double radius_m, bool free_scale);

}  // namespace hybrid::stages
