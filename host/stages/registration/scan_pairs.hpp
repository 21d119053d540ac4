#pragma once
#include <algorithm>
#include <vector>

#include "stages/registration/icp_pairs.hpp"
#include "stages/registration/icp_scan.hpp"
#include "stages/registration/scan_surface.hpp"

namespace hybrid::stages {

// Samples of one kind of one scan on the surface of another. `forward`: of the scan that moves.
class ScanPairs {
 public:
  // `own_spacing`: of the samples' scan, per metre of range, to use only what the surface has more densely; 0
  // = all.
  ScanPairs(device::Queue& queue, const IcpScan::Samples& samples, const ScanSurface& surface,
            double own_spacing, bool forward);

  // `from`: of the samples' scan, `to`: of the surface's.
  void find(const Pose& world_from, const Pose& world_to, double gate_m, double normal_deg);

  // World metres, per sample.
  std::vector<float> heights() const { return in_world(answers_.height); }
  // Of those that count, the others NaN.
  std::vector<float> used_heights() const { return in_world(used()); }
  std::vector<float> clearances() const { return in_world(answers_.clearance); }

  // Adds `factor` times the normal equations of the moving scan's step about `pivot` (world).
  void add_sums(const Vec3& pivot, double cutoff_m, double factor, PlaneSums& total);

  const IcpScan::Samples& samples() const { return samples_; }
  bool forward() const { return forward_; }

 private:
  const device::Array<float>& used() const { return own_spacing_ > 0 ? dense_ : answers_.height; }
  void leave_out_coarse();
  std::vector<float> in_world(const device::Array<float>& values) const;

  const IcpScan::Samples& samples_;
  double own_spacing_;
  bool forward_;
  device::Queue& queue_;
  const ScanSurface& surface_;
  SampleAnswers answers_;
  device::Array<float> dense_;  // heights, NaN where the surface is coarser than the samples
  device::Array<float> partial_;
  Pose scan_from_queries_, world_from_grid_, world_from_;
};

// Tukey's cutoff of one kind of samples: the scale may at most halve per iteration, as that of ICP to a
// model.
class PairsCutoff {
 public:
  explicit PairsCutoff(double floor_m) : floor_(floor_m) {}
  // False without pairs.
  bool update(const std::vector<float>& heights, const std::vector<float>& areas);
  bool paired() const { return paired_; }
  bool settled() const { return !paired_ || settled_; }
  double scale_m() const { return scale_; }
  double metres() const { return 4.685 * scale_; }

 private:
  double floor_, scale_ = 0;
  bool paired_ = false, settled_ = false;
};

// How many of the pairs within a cutoff are independent: a supercluster's are off together (they share its
// normal).
class PairObservations {
 public:
  void add(const ScanPairs& pairs, double cutoff_m);
  double samples() const { return samples_; }
  // As many as there are planes of one area, 1 at least.
  double planes() const { return squares_ > 0 ? std::max(area_ * area_ / squares_, 1.0) : 1; }

 private:
  double samples_ = 0, area_ = 0, squares_ = 0;
};

}  // namespace hybrid::stages
