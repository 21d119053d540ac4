#include "stages/registration/scan_icp.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "stages/registration/icp_step.hpp"
#include "stages/registration/scan_pairs.hpp"
#include "stages/registration/seen_samples.hpp"

namespace hybrid::stages {
namespace {

constexpr double kScanSettledAngleRad = 2e-6, kScanSettledDistanceM = 1e-5;
constexpr double kGateOfCutoff = 2;  // pairs beyond the robust weights' cutoff may come back
// Samples outside superclusters that stand for one independent observation: neighbours share what is wrong.
constexpr double kFreePerObservation = 100;
constexpr std::size_t kFree = 1 - IcpScan::kPlanar;
constexpr double kNearOverlap = 0.1;

class ScanProblem {
 public:
  ScanProblem(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
              const ScanIcpOptions& options)
      : scan_(scan),
        placed_(placed),
        options_(options),
        cutoffs_{PairsCutoff(options.scale_floor_m), PairsCutoff(options.scale_floor_m)} {
    for (std::size_t other = 0; other < placed.size(); ++other)
      for (std::size_t kind = 0; kind < 2; ++kind) {
        if (placed[other].scan->surface->known())
          pairs_.push_back({other, kind,
                            ScanPairs(queue, of(scan)[kind], *placed[other].scan->surface,
                                      own_spacing(scan, kind), true)});
        if (scan.surface->known())
          pairs_.push_back({other, kind,
                            ScanPairs(queue, of(*placed[other].scan)[kind], *scan.surface,
                                      own_spacing(*placed[other].scan, kind), false)});
      }
  }

  void find(const Pose& pose, double gate_m) {
    for (std::size_t kind = 0; kind < 2; ++kind) find(pose, gate_m, kind);
  }
  void find(const Pose& pose, double gate_m, std::size_t only) {
    for (auto& [other, kind, pairs] : pairs_) {
      if (kind != only) continue;
      const Pose& there = placed_[other].world_from_scan;
      pairs.find(pairs.forward() ? pose : there, pairs.forward() ? there : pose, gate_m, options_.normal_deg);
    }
  }

  // The scales of both kinds of samples from the pairs' heights. False without pairs.
  bool update_cutoffs() {
    bool any = false;
    for (std::size_t kind = 0; kind < 2; ++kind) {
      std::vector<float> heights, areas;
      for (auto& one : pairs_) {
        if (one.kind != kind) continue;
        const auto& own = one.pairs.used_heights();
        heights.insert(heights.end(), own.begin(), own.end());
        const auto& area = one.pairs.samples().area_m2;
        areas.insert(areas.end(), area.begin(), area.end());
      }
      any |= cutoffs_[kind].update(heights, areas);
    }
    return any;
  }
  bool settled() const { return cutoffs_[0].settled() && cutoffs_[1].settled(); }
  double widest_cutoff_m() const {
    double widest = 0;
    for (const PairsCutoff& cutoff : cutoffs_)
      if (cutoff.paired()) widest = std::max(widest, cutoff.metres());
    return widest;
  }

  // Each kind counts by what it is off.
  PlaneSums sums(const Vec3& pivot) {
    for (auto& one : pairs_)
      if (cutoffs_[one.kind].paired()) one.pairs.sum(pivot, cutoffs_[one.kind].metres());
    std::array<double, 2> factors;
    for (std::size_t kind = 0; kind < 2; ++kind)
      factors[kind] = 1 / (cutoffs_[kind].scale_m() * cutoffs_[kind].scale_m());
    return same_sums(factors);
  }
  // The last ones, weighted otherwise.
  PlaneSums same_sums(const std::array<double, 2>& factors) {
    PlaneSums total;
    for (auto& one : pairs_)
      if (cutoffs_[one.kind].paired()) one.pairs.add_sums(factors[one.kind], total);
    return total;
  }

  double radius_m(const Pose& pose) const { return pose.scale * scan_.radius_m; }
  void compare(const Pose& pose, ScanIcp& result, const std::function<bool(const ScanIcp&)>& enough = {});
  void describe(const Pose& pose, ScanIcp& result);

 private:
  struct Kind {
    std::size_t other, kind;
    ScanPairs pairs;
  };
  const std::array<IcpScan::Samples, 2>& of(const IcpScan& scan) const { return samples_of(scan, options_); }
  static double own_spacing(const IcpScan& scan, std::size_t kind) {
    return kind == 1 && scan.surface->known() ? scan.surface->spacing() : 0;
  }
  Seen seen_of_free();
  void overlaps(ScanIcp& result);
  double observations(std::size_t kind);

  const IcpScan& scan_;
  const std::vector<PlacedScan>& placed_;
  const ScanIcpOptions& options_;
  std::array<PairsCutoff, 2> cutoffs_;
  std::vector<Kind> pairs_;
};

Seen ScanProblem::seen_of_free() {
  Seen seen;
  for (auto& one : pairs_)
    if (one.kind == kFree)
      add_seen(one.pairs.samples(), one.pairs.heights(), one.pairs.clearances(), options_, seen);
  return seen;
}

// What lies on surfaces of the other scans, and what these look through.
void ScanProblem::overlaps(ScanIcp& result) {
  struct Compared {
    double forward = 0, backward = 0, through = 0, square = 0;
  };
  std::vector<Compared> compared(placed_.size());
  std::array<Seen, 2> seen;                 // by kind
  std::array<std::vector<char>, 2> on_any;  // per own sample
  for (std::size_t kind = 0; kind < 2; ++kind) on_any[kind].assign(of(scan_)[kind].area_m2.size(), 0);
  for (auto& [other, kind, pairs] : pairs_) {
    const auto &heights = pairs.heights(), &clearances = pairs.clearances();
    const auto& area = pairs.samples().area_m2;
    Compared& sums = compared[other];
    for (std::size_t i = 0; i < area.size(); ++i) {
      const double height = heights[i], a = area[i];
      if (std::abs(height) < options_.overlap_m) {
        (pairs.forward() ? sums.forward : sums.backward) += a;
        sums.square += a * height * height;
        seen[kind].on += a;
        if (pairs.forward()) on_any[kind][i] = 1;
      } else if (static_cast<double>(clearances[i]) > options_.clear_m) {
        sums.through += a;
        seen[kind].through += a;
      }
    }
    if (kind == IcpScan::kPlanar)
      add_planes(pairs.samples(), (pairs.forward() ? scan_ : *placed_[other].scan).area_m2, heights,
                 clearances, pairs.forward() ? result.icp.world_from_scan : placed_[other].world_from_scan,
                 options_, result.planes);
  }
  for (std::size_t k = 0; k < compared.size(); ++k) {
    const Compared& sums = compared[k];
    ScanOverlap one;
    one.on_m2 = sums.forward + sums.backward;
    one.through_m2 = sums.through;
    one.overlap = std::max(scan_.area_m2 > 0 ? sums.forward / scan_.area_m2 : 0,
                           placed_[k].scan->area_m2 > 0 ? sums.backward / placed_[k].scan->area_m2 : 0);
    if (one.on_m2 > 0) one.rms_m = std::sqrt(sums.square / one.on_m2);
    result.others.push_back(one);
  }
  tell(seen[IcpScan::kPlanar], seen[kFree], result);
  double own = 0;
  for (std::size_t kind = 0; kind < 2; ++kind)
    for (std::size_t i = 0; i < on_any[kind].size(); ++i)
      if (on_any[kind][i]) own += of(scan_)[kind].area_m2[i];
  result.icp.overlap = scan_.area_m2 > 0 ? own / scan_.area_m2 : 0;
}

// How many of a kind's pairs are independent: of those outside superclusters, neighbours are off together.
double ScanProblem::observations(std::size_t kind) {
  PairObservations seen;
  for (auto& one : pairs_)
    if (one.kind == kind) seen.add(one.pairs, cutoffs_[kind].metres());
  return kind == IcpScan::kPlanar ? seen.planes() : std::max(seen.samples() / kFreePerObservation, 1.0);
}

void ScanProblem::compare(const Pose& pose, ScanIcp& result,
                          const std::function<bool(const ScanIcp&)>& enough) {
  find(pose, options_.overlap_m, kFree);
  if (enough) {
    tell_free(seen_of_free(), result);
    if (enough(result)) return;
  }
  find(pose, options_.overlap_m, IcpScan::kPlanar);
  overlaps(result);
}

void ScanProblem::describe(const Pose& pose, ScanIcp& result) {
  compare(pose, result);
  if (!update_cutoffs()) return;
  const Vec3 pivot = pose * scan_.centre;
  const PlaneSums all = sums(pivot);
  if (!(all.weight > 0)) return;
  // Of what lies within the cutoffs, both kinds by area.
  const PlaneSums by_area = same_sums({1, 1});
  result.icp.rms_m = std::sqrt(by_area.mean_square());
  result.icp.degenerate = degenerate_directions(all, radius_m(pose), false).in_words();
  std::array<double, 2> factors{};
  for (std::size_t kind = 0; kind < 2; ++kind) {
    std::array<double, 2> only{};
    only[kind] = 1;
    const PlaneSums own = same_sums(only);
    if (own.weight > 0)
      factors[kind] = observations(kind) / (own.weight * cutoffs_[kind].scale_m() * cutoffs_[kind].scale_m());
  }
  const PlaneSums informed = same_sums(factors);
  result.icp.covariance = pose_covariance(informed, 1 / informed.weight, pivot, radius_m(pose), false);
}

double share_of(double part_m2, const ComparedPlanes& planes) {
  const double total = planes.on.trace() + planes.through.trace();
  return total > 0 ? part_m2 / total : 0;
}

}  // namespace

ComparedPlanes::Weakest ComparedPlanes::weakest() const {
  const double total = on.trace();
  if (!(total > 0)) return {};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(on);
  return {solver.eigenvalues()(0) / total, solver.eigenvectors().col(0)};
}

double ComparedPlanes::contradicted() const {
  return share_of(contradicted_m2, *this);
}

double ComparedPlanes::beside() const {
  return share_of(beside_m2, *this);
}

ComparedPlanes& ComparedPlanes::operator+=(const ComparedPlanes& with_others) {
  on += with_others.on;
  through += with_others.through;
  contradicted_m2 += with_others.contradicted_m2;
  beside_m2 += with_others.beside_m2;
  farthest_m = std::max(farthest_m, with_others.farthest_m);
  return *this;
}

PlaceEvidence& PlaceEvidence::operator+=(const PlaceEvidence& of_others) {
  const auto through_m2 = [](const PlaceEvidence& one) { return one.free_seen_through * one.free_m2; };
  const double through = through_m2(*this) + through_m2(of_others), all = free_m2 + of_others.free_m2;
  planes += of_others.planes;
  const Seen planar{planes.on.trace(), planes.through.trace()};  // of unit normals
  tell(planar, {all - through, through}, *this);
  return *this;
}

ScanIcp register_to_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                          const Pose& start, const ScanIcpOptions& options) {
  ScanProblem problem(queue, scan, placed, options);
  ScanIcp result;
  Registration& icp = result.icp;
  icp.world_from_scan = start;
  double gate = options.gate_m;
  bool returned = false;
  while (!icp.converged && icp.iterations < options.max_iterations) {
    problem.find(icp.world_from_scan, gate);
    if (!problem.update_cutoffs()) break;
    const Vec3 pivot = icp.world_from_scan * scan.centre;
    const double radius = problem.radius_m(icp.world_from_scan);
    const PlaneSums sums = problem.sums(pivot);
    if (!(sums.weight > 0)) break;
    const StepSize step = apply_plane_step(sums, pivot, radius, false, icp.world_from_scan);
    const double next = std::clamp(kGateOfCutoff * problem.widest_cutoff_m(), options.least_gate_m, gate);
    const bool still = step.angle_rad < kScanSettledAngleRad && step.distance_m < kScanSettledDistanceM;
    icp.converged = still && problem.settled() && next > 0.9 * gate;
    gate = next;
    ++icp.iterations;
    if (!icp.converged || returned) continue;
    const StepSize back = return_along_open(problem.sums(icp.world_from_scan * scan.centre), scan.centre,
                                            radius, start, icp.world_from_scan);
    icp.converged = back.angle_rad < kScanSettledAngleRad && back.distance_m < kScanSettledDistanceM;
    returned = true;
  }
  problem.describe(icp.world_from_scan, result);
  return result;
}

ScanIcp assess_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                        const Pose& pose, const ScanIcpOptions& options) {
  ScanProblem problem(queue, scan, placed, options);
  ScanIcp result;
  result.icp.world_from_scan = pose;
  result.icp.converged = true;
  problem.describe(pose, result);
  return result;
}

ScanIcp compare_on_scans(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                         const Pose& pose, const ScanIcpOptions& options,
                         const std::function<bool(const ScanIcp&)>& enough) {
  ScanProblem problem(queue, scan, placed, options);
  ScanIcp result;
  result.icp.world_from_scan = pose;
  result.icp.converged = true;
  problem.compare(pose, result, enough);
  return result;
}

std::vector<PlacedScan> near_scans(const std::vector<PlacedScan>& placed, const ScanIcp& found) {
  std::vector<PlacedScan> near;
  for (std::size_t k = 0; k < placed.size(); ++k)
    if (found.others[k].overlap >= kNearOverlap) near.push_back(placed[k]);
  return near;
}

ScanIcp register_to_some(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& some,
                         const std::vector<PlacedScan>& placed, const Pose& start,
                         const ScanIcpOptions& options) {
  const ScanIcp end = register_to_scans(queue, scan, some.empty() ? placed : some, start, options);
  ScanIcp found = assess_on_scans(queue, scan, placed, end.icp.world_from_scan, options);
  found.icp.converged = end.icp.converged;
  found.icp.iterations = end.icp.iterations;
  return found;
}

}  // namespace hybrid::stages
