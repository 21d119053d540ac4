#pragma once
#include <array>
#include <optional>
#include <vector>

#include "stages/registration/automatic_scene.hpp"

namespace hybrid::stages {

// One scan of several that see parts of the same planes.
struct JointScan {
  const ScanEvidence* evidence = nullptr;  // its tiles
  const ModelShapes* shapes = nullptr;     // its own superclusters (model_of_scan), scan frame
  Pose start;                              // near: neighbours' planes lie within JointOptions::reach_m
  bool fixed = false;                      // its pose stays
  // What is known of the start without the other scans: 6x6 as Registration::covariance. Nothing for a scan
  // that only its neighbours hold.
  std::optional<std::array<double, 36>> covariance;
  // What faces of the model are off, as other scans show: a scan that sees few of them cannot tell.
  double face_sigma_m = 0;
};

struct JointOptions {
  double reach_m = 0.3;         // planes of two scans that are one lie this near under the start poses
  double least_sigma_m = 5e-4;  // of a plane of one scan over the same plane of another
};

// What surveyors read in registration reports.
struct PairReport {
  std::size_t a = 0, b = 0;  // scans, a < b
  double overlap = 0;  // share of the planar area of the one that sees less that lies on planes of the other
  double area_m2 = 0;  // of it, both ways
  double distance_m = 0;        // rms distance of these tiles from the other scan's planes
  double start_distance_m = 0;  // of the same tiles under the start poses
  double median_m = 0;          // median by area
  double strength = 0;          // 1: held alike in all directions; 0: free to slide along one
  int planes = 0;               // pairs of superclusters
};

struct JointPoses {
  std::vector<Pose> world_from_scan;               // one per scan
  std::vector<std::array<double, 36>> covariance;  // as Registration::covariance; 0 of fixed scans
  std::vector<PairReport> pairs;                   // those with overlap, a then b ascending
  double sigma_m = 0;                              // of a plane of one scan over the same of another
  int iterations = 0;
  bool converged = false;
};

// METHOD 7, many scans: all poses together, so that planes that two scans share fall together (tiles of one
// over superclusters of the other, both ways, Tukey weights whose scale at most halves per round; every pair
// of superclusters is one observation of what a plane is off) while each keeps to what its own start is known
// to. Without any fixed scan and covariance the first is fixed. Scans not held by anything stay as they are.
// Solved by Ceres on one thread: the same bytes every run.
JointPoses refine_jointly(const std::vector<JointScan>& scans, const JointOptions& options = {});

}  // namespace hybrid::stages
