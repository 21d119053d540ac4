#include "stages/registration/scan_icp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/params_icp_sums.h"
#include "stages/registration/icp_pairs.hpp"
#include "stages/registration/icp_step.hpp"

namespace hybrid::stages {
namespace {

constexpr double kScanSettledAngleRad = 2e-6, kScanSettledDistanceM = 1e-5;
constexpr double kGateOfCutoff = 2;  // pairs beyond the robust weights' cutoff may come back
// Samples outside superclusters that stand for one independent observation: neighbours share what is wrong.
constexpr double kFreePerObservation = 100;
// Leaves and railings are seen through from elsewhere: where planes are so much of what can be compared, they
// alone tell what is seen through.
constexpr double kPlanesTell = 0.2;
constexpr int kSamplesOfPlane = 5;  // seen through, that contradict it

// Samples of one kind of one scan on the surface of another. `forward`: of the scan that moves.
class Pairs {
 public:
  // `own_spacing`: of the samples' scan, per metre of range, to use only what the surface has more densely; 0
  // = all.
  Pairs(device::Queue& queue, const IcpScan::Samples& samples, const ScanSurface& surface, double own_spacing,
        bool forward)
      : samples_(samples),
        own_spacing_(own_spacing),
        forward_(forward),
        queue_(queue),
        surface_(surface),
        answers_(queue, samples.queries.count),
        partial_(queue.array<float>((samples.queries.count + kSamplesPerSum - 1) / kSamplesPerSum *
                                    ICP_PLANE_SUMS)) {}

  // `from`: of the samples' scan, `to`: of the surface's.
  void find(const Pose& world_from, const Pose& world_to, double gate_m, double normal_deg) {
    scan_from_queries_ = world_to.inverse() * world_from;
    world_from_grid_ = world_to * surface_.grid_from_scan().inverse();
    world_from_ = world_from;
    if (samples_.queries.count == 0) return;
    surface_.find(samples_.queries, scan_from_queries_, gate_m / world_to.scale, normal_deg, answers_);
    if (own_spacing_ > 0) leave_out_coarse();
  }

  // World metres, per sample.
  std::vector<float> heights() const { return in_world(answers_.height); }
  // Of those that count, the others NaN.
  std::vector<float> used_heights() const { return in_world(used()); }
  std::vector<float> distances() const { return in_world(answers_.distance); }
  std::vector<float> clearances() const { return in_world(answers_.clearance); }

  // Adds `factor` times the normal equations of the moving scan's step about `pivot` (world).
  void add_sums(const Vec3& pivot, double cutoff_m, double factor, PlaneSums& total);

  const IcpScan::Samples& samples() const { return samples_; }
  bool forward() const { return forward_; }

 private:
  const device::Array<float>& used() const { return own_spacing_ > 0 ? dense_ : answers_.height; }
  void leave_out_coarse();
  std::vector<float> in_world(const device::Array<float>& values) const {
    auto read = queue_.read(values);
    if (world_from_grid_.scale != 1)
      for (float& value : read) value *= static_cast<float>(world_from_grid_.scale);
    return read;
  }

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

// What lies in no plane is told by the samples around, and the worse the farther these are: where two scans
// have it, it is where the denser one says. (With the coarser one's word churches held through a door came to
// lie two to eight times as far off.)
void Pairs::leave_out_coarse() {
  auto heights = queue_.read(answers_.height);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto& p = samples_.points[i];
    const Vec3 point(p[0], p[1], p[2]);
    const double own = scan_from_queries_.scale * point.norm() * own_spacing_,
                 there = (scan_from_queries_ * point).norm() * surface_.spacing();
    if (there > own) heights[i] = std::numeric_limits<float>::quiet_NaN();
  }
  dense_ = queue_.array(heights);
}

// The device sums in the axes of the grid, in its scale; a sample of the scan that stays, on a surface of the
// one that moves, has the Jacobian of the former with the other sign.
void Pairs::add_sums(const Vec3& pivot, double cutoff_m, double factor, PlaneSums& total) {
  const std::size_t count = samples_.queries.count;
  if (count == 0) return;
  const double scale = world_from_grid_.scale;
  const Pose grid_from_queries = surface_.grid_from_scan() * scan_from_queries_;
  const Mat3 linear = grid_from_queries.scale * grid_from_queries.rotation.toRotationMatrix();
  const Vec3 centre = world_from_.inverse() * pivot;
  IcpSumsParams params{};
  for (int k = 0; k < 9; ++k) params.linear[k] = static_cast<float>(linear(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) params.centre_scan[k] = static_cast<float>(centre(k));
  params.cutoff = static_cast<float>(cutoff_m / scale);
  params.samples = static_cast<std::uint32_t>(count);
  const std::size_t blocks = (count + kSamplesPerSum - 1) / kSamplesPerSum;
  const auto& kernel = queue_.kernel("icp_sums", {{"VW", queue_.vector_width()},
                                                  {"BLOCK", static_cast<int>(kSamplesPerSum)},
                                                  {"POINT", 0},
                                                  {"NORMALS", 1}});
  const auto no_triangle = queue_.array<std::uint32_t>(0);
  const auto no_triangles = queue_.array<ProxyTriangle>(0);
  queue_.launch("icp_sums", kernel, device::grid(blocks), params, samples_.queries.x, samples_.queries.y,
                samples_.queries.z, samples_.area, used(), no_triangle, answers_.normal_x, answers_.normal_y,
                answers_.normal_z, no_triangles, partial_);
  std::array<double, ICP_PLANE_SUMS> sums{};
  const auto partial = queue_.read(partial_);
  for (std::size_t k = 0; k < partial.size(); ++k) sums[k % sums.size()] += static_cast<double>(partial[k]);

  Matrix7 matrix;
  Vector7 right;
  std::size_t k = 0;
  for (int row = 0; row < 7; ++row) {
    for (int col = row; col < 7; ++col) matrix(row, col) = matrix(col, row) = sums[k++];
    right(row) = sums[static_cast<std::size_t>(28 + row)];
  }
  Matrix7 to_world = Matrix7::Zero();
  const Mat3 turn = world_from_grid_.rotation.toRotationMatrix();
  to_world.topLeftCorner<3, 3>() = scale * turn;
  to_world.block<3, 3>(3, 3) = turn;
  to_world(6, 6) = scale;
  total.matrix += factor * (to_world * matrix * to_world.transpose());
  total.right += (forward_ ? factor : -factor) * scale * (to_world * right);
  total.weight += factor * sums[35];
  total.inlier_area += factor * sums[36];
  total.inlier_square += factor * scale * scale * sums[37];
}

// Tukey's cutoff of one kind of samples: the scale may at most halve per iteration, as that of ICP to a
// model.
class KindCutoff {
 public:
  explicit KindCutoff(double floor_m) : floor_(floor_m) {}
  // False without pairs.
  bool update(const std::vector<float>& heights, const std::vector<float>& areas) {
    const double middle = weighted_median(heights, areas);
    paired_ = middle >= 0;
    if (!paired_) return false;
    const double wanted = std::max(1.4826 * middle, floor_);
    settled_ = wanted >= 0.5 * scale_;
    scale_ = std::max(wanted, 0.5 * scale_);
    return true;
  }
  bool paired() const { return paired_; }
  bool settled() const { return !paired_ || settled_; }
  double scale_m() const { return scale_; }
  double metres() const { return 4.685 * scale_; }

 private:
  double floor_, scale_ = 0;
  bool paired_ = false, settled_ = false;
};

class ScanProblem {
 public:
  ScanProblem(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
              const ScanIcpOptions& options)
      : scan_(scan),
        placed_(placed),
        options_(options),
        cutoffs_{KindCutoff(options.scale_floor_m), KindCutoff(options.scale_floor_m)} {
    for (std::size_t other = 0; other < placed.size(); ++other)
      for (std::size_t kind = 0; kind < 2; ++kind) {
        if (placed[other].scan->surface->known())
          pairs_.push_back(
              {other, kind,
               Pairs(queue, of(scan)[kind], *placed[other].scan->surface, own_spacing(scan, kind), true)});
        if (scan.surface->known())
          pairs_.push_back({other, kind,
                            Pairs(queue, of(*placed[other].scan)[kind], *scan.surface,
                                  own_spacing(*placed[other].scan, kind), false)});
      }
  }

  void find(const Pose& pose, double gate_m) {
    for (auto& [other, kind, pairs] : pairs_) {
      const Pose& there = placed_[other].world_from_scan;
      pairs.find(pairs.forward() ? pose : there, pairs.forward() ? there : pose, gate_m, options_.normal_deg);
    }
  }

  // The scales of both kinds of samples from the pairs' heights. False without pairs.
  bool update_cutoffs() {
    bool any = false;
    for (std::size_t kind = 0; kind < 2; ++kind) {
      std::vector<float> heights, areas;
      for (const auto& one : pairs_) {
        if (one.kind != kind) continue;
        const auto own = one.pairs.used_heights();
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
    for (const KindCutoff& cutoff : cutoffs_)
      if (cutoff.paired()) widest = std::max(widest, cutoff.metres());
    return widest;
  }

  // Each kind counts by what it is off.
  PlaneSums sums(const Vec3& pivot) {
    std::array<double, 2> factors;
    for (std::size_t kind = 0; kind < 2; ++kind)
      factors[kind] = 1 / (cutoffs_[kind].scale_m() * cutoffs_[kind].scale_m());
    return sums(pivot, factors);
  }
  PlaneSums sums(const Vec3& pivot, const std::array<double, 2>& factors) {
    PlaneSums total;
    for (auto& one : pairs_)
      if (cutoffs_[one.kind].paired())
        one.pairs.add_sums(pivot, cutoffs_[one.kind].metres(), factors[one.kind], total);
    return total;
  }

  double radius_m(const Pose& pose) const { return pose.scale * scan_.radius_m; }
  void describe(const Pose& pose, ScanIcp& result);

 private:
  struct Kind {
    std::size_t other, kind;
    Pairs pairs;
  };
  const std::array<IcpScan::Samples, 2>& of(const IcpScan& scan) const {
    return options_.few ? scan.few : scan.samples;
  }
  static double own_spacing(const IcpScan& scan, std::size_t kind) {
    return kind == 1 && scan.surface->known() ? scan.surface->spacing() : 0;
  }
  void overlaps(ScanIcp& result);
  void add_planes(const IcpScan::Samples& samples, const std::vector<float>& heights,
                  const std::vector<float>& clearances, const Pose& world_from_samples,
                  ComparedPlanes& planes) const;
  double observations(std::size_t kind) const;

  const IcpScan& scan_;
  const std::vector<PlacedScan>& placed_;
  const ScanIcpOptions& options_;
  std::array<KindCutoff, 2> cutoffs_;
  std::vector<Kind> pairs_;
};

// The samples of a supercluster follow each other and share its normal.
void ScanProblem::add_planes(const IcpScan::Samples& samples, const std::vector<float>& heights,
                             const std::vector<float>& clearances, const Pose& world_from_samples,
                             ComparedPlanes& planes) const {
  for (std::size_t begin = 0, end = 0; begin < heights.size(); begin = end) {
    double on = 0, through = 0;
    int seen_through = 0;
    for (end = begin; end < heights.size() && samples.normals[end] == samples.normals[begin]; ++end) {
      if (std::abs(static_cast<double>(heights[end])) < options_.overlap_m) {
        on += samples.area_m2[end];
      } else if (static_cast<double>(clearances[end]) > options_.clear_m) {
        through += samples.area_m2[end];
        ++seen_through;
      }
    }
    const auto& n = samples.normals[begin];
    const Vec3 normal = world_from_samples.rotate(Vec3(n[0], n[1], n[2]));
    planes.on += on * normal * normal.transpose();
    planes.through += through * normal * normal.transpose();
    if (through > on && seen_through >= kSamplesOfPlane) planes.contradicted_m2 += through;
  }
}

// What lies on surfaces of the other scans, and what these look through.
void ScanProblem::overlaps(ScanIcp& result) {
  struct Compared {
    double forward = 0, backward = 0, through = 0, square = 0;
  };
  struct Seen {
    double on = 0, through = 0;
    double all() const { return on + through; }
  };
  std::array<Seen, 2> seen;  // by kind
  std::vector<Compared> compared(placed_.size());
  std::array<std::vector<char>, 2> on_any;  // per own sample
  for (std::size_t kind = 0; kind < 2; ++kind) on_any[kind].assign(of(scan_)[kind].area_m2.size(), 0);
  for (const auto& [other, kind, pairs] : pairs_) {
    const auto heights = pairs.heights(), clearances = pairs.clearances();
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
      add_planes(pairs.samples(), heights, clearances,
                 pairs.forward() ? result.icp.world_from_scan : placed_[other].world_from_scan,
                 result.planes);
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
  const bool by_planes = seen[0].all() > kPlanesTell * (seen[0].all() + seen[1].all());
  const Seen judge{seen[0].on + (by_planes ? 0 : seen[1].on),
                   seen[0].through + (by_planes ? 0 : seen[1].through)};
  const Seen& free = seen[1 - IcpScan::kPlanar];
  result.free_m2 = free.all();
  if (free.all() > 0) result.free_seen_through = free.through / free.all();
  if (judge.all() > 0) result.seen_through = judge.through / judge.all();
  double own = 0;
  for (std::size_t kind = 0; kind < 2; ++kind)
    for (std::size_t i = 0; i < on_any[kind].size(); ++i)
      if (on_any[kind][i]) own += of(scan_)[kind].area_m2[i];
  result.icp.overlap = scan_.area_m2 > 0 ? own / scan_.area_m2 : 0;
}

// How many of a kind's pairs are independent: a supercluster's are off together (they share its normal), and
// so are neighbours outside superclusters.
double ScanProblem::observations(std::size_t kind) const {
  double total = 0, squares = 0, samples = 0;
  for (const auto& one : pairs_) {
    if (one.kind != kind) continue;
    const auto heights = one.pairs.used_heights();
    const auto& with = one.pairs.samples();
    double of_this = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      if (i > 0 && with.normals[i] != with.normals[i - 1]) {
        squares += of_this * of_this;
        of_this = 0;
      }
      if (!(std::abs(static_cast<double>(heights[i])) < cutoffs_[kind].metres())) continue;
      total += with.area_m2[i];
      of_this += with.area_m2[i];
      ++samples;
    }
    squares += of_this * of_this;
  }
  if (kind == 1) return std::max(samples / kFreePerObservation, 1.0);
  return squares > 0 ? std::max(total * total / squares, 1.0) : 1;
}

void ScanProblem::describe(const Pose& pose, ScanIcp& result) {
  find(pose, options_.overlap_m);
  overlaps(result);
  if (!update_cutoffs()) return;
  const Vec3 pivot = pose * scan_.centre;
  const PlaneSums all = sums(pivot);
  if (!(all.weight > 0)) return;
  // Of what lies within the cutoffs, both kinds by area.
  const PlaneSums by_area = sums(pivot, {1, 1});
  result.icp.rms_m = std::sqrt(by_area.mean_square());
  result.icp.degenerate = degenerate_directions(all, radius_m(pose), false);
  std::array<double, 2> factors{};
  for (std::size_t kind = 0; kind < 2; ++kind) {
    std::array<double, 2> only{};
    only[kind] = 1;
    const PlaneSums own = sums(pivot, only);
    if (own.weight > 0)
      factors[kind] = observations(kind) / (own.weight * cutoffs_[kind].scale_m() * cutoffs_[kind].scale_m());
  }
  const PlaneSums informed = sums(pivot, factors);
  result.icp.covariance = pose_covariance(informed, 1 / informed.weight, pivot, radius_m(pose), false);
}

}  // namespace

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

}  // namespace hybrid::stages
