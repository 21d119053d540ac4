#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "shared/params_icp_sums.h"
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

  // `from`: of the samples' scan, `to`: of the surface's. Returns at once.
  void find(const Pose& world_from, const Pose& world_to, double gate_m, double normal_deg);

  // Of the last find(), world metres, per sample.
  const std::vector<float>& heights() { return in_world(raw_heights(), world_heights_); }
  // Of those that count, the others NaN.
  const std::vector<float>& used_heights() { return in_world(raw_used(), world_used_); }
  const std::vector<float>& clearances() { return in_world(raw_clearances(), world_clearances_); }

  // Sums the normal equations of the moving scan's step about `pivot` (world), and returns at once.
  void sum(const Vec3& pivot, double cutoff_m);
  // Adds `factor` times what sum() summed.
  void add_sums(double factor, PlaneSums& total);

  const IcpScan::Samples& samples() const { return samples_; }
  bool forward() const { return forward_; }

 private:
  const std::vector<float>& raw_heights();
  const std::vector<float>& raw_used();
  const std::vector<float>& raw_clearances();
  // The values themselves where the grid's scale is the world's.
  const std::vector<float>& in_world(const std::vector<float>& values, std::vector<float>& scaled) const;

  const IcpScan::Samples& samples_;
  double own_spacing_;
  bool forward_;
  device::Queue& queue_;
  const ScanSurface& surface_;
  SampleAnswers answers_;
  // Read when first asked for, in the grid's scale: clearances, heights, and these with NaN where the surface
  // is coarser than the samples, which the device gets, too.
  std::optional<std::vector<float>> clearances_, heights_, dense_heights_;
  std::vector<float> world_clearances_, world_heights_, world_used_;
  device::Array<float> dense_, partial_;
  std::optional<std::array<double, ICP_PLANE_SUMS>> sums_;  // read when first asked for
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
  void add(ScanPairs& pairs, double cutoff_m);
  double samples() const { return samples_; }
  // As many as there are planes of one area, 1 at least.
  double planes() const { return squares_ > 0 ? std::max(area_ * area_ / squares_, 1.0) : 1; }

 private:
  double samples_ = 0, area_ = 0, squares_ = 0;
};

}  // namespace hybrid::stages
