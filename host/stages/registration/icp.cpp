#include "stages/registration/icp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "stages/registration/icp_pairs.hpp"
#include "stages/registration/icp_step.hpp"

namespace hybrid::stages {
namespace {

constexpr double kNoCutoff_m = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewestSamples = 10;  // some tens suffice, a few hold no pose
constexpr double kOverlapM = 0.05;
constexpr double kSettledAngleRad = 1e-6, kSettledDistanceM = 5e-6;

void check(const PlanarSamples& samples, const Pose& start, const IcpOptions& options) {
  if (samples.points.empty())
    fail_input(
        "registration: the scan has no planar samples; it needs superclusters (lower min_squares or check "
        "the "
        "units of the scan)");
  if (options.max_samples > 0 && samples.points.size() < kFewestSamples)
    fail_input(
        "registration: expected at least {} planar samples to hold a pose, found {} of max_samples = {} in "
        "[register]; raise it (0 = all)",
        kFewestSamples, samples.points.size(), options.max_samples);
  if (!start.translation.allFinite() || !start.rotation.coeffs().allFinite() || !std::isfinite(start.scale) ||
      start.scale <= 0)
    fail_input("registration: the start pose is not finite or its scale not positive");
  for (const auto& row : icp_option_table())
    if (std::holds_alternative<std::string IcpOptions::*>(row.member)) {
      IcpOptions copy = options;
      set_option(copy, row, get_option(options, row));
    }
}

// Tukey's cutoff from the pairs' errors. The scale may at most halve per iteration (FINDINGS.md): floor and
// ceiling are most of the area, and a plain median locks onto them while walls are still misplaced.
class Cutoff {
 public:
  Cutoff(const IcpOptions& options) : tukey_(options.robust == "tukey"), floor_(options.scale_floor_m) {}

  // False when there are no pairs.
  bool update(const std::vector<float>& errors, const std::vector<float>& areas) {
    const double median = weighted_median(errors, areas);
    if (median < 0) return false;
    const double wanted = std::max(1.4826 * median, floor_);
    settled_ = !tukey_ || wanted >= 0.5 * scale_;
    scale_ = std::max(wanted, 0.5 * scale_);
    return true;
  }
  double metres() const { return tukey_ ? 4.685 * scale_ : kNoCutoff_m; }
  bool settled() const { return settled_; }

 private:
  bool tukey_, settled_ = false;
  double floor_, scale_ = 0;
};

[[noreturn]] void fail_without_pairs(const IcpOptions& options) {
  fail_input(
      "registration: no planar sample has a face {}with a normal within {} degrees of its own; check that "
      "the "
      "model's faces show their front sides (counter-clockwise) to the scanner, and the start pose",
      options.gate_m > 0 ? fmt::format("within the gate of {} m and ", options.gate_m) : "",
      options.normal_deg);
}

// Point-to-plane step; returns whether it was too small to matter.
bool plane_step(IcpPairs& pairs, const Cutoff& cutoff, bool free_scale, Registration& result) {
  const PlaneSums sums = pairs.plane_sums(cutoff.metres());
  result.rms_history_m.push_back(std::sqrt(sums.mean_square()));
  const double radius = result.world_from_scan.scale * pairs.radius_m();
  const StepSize step = apply_plane_step(sums, result.world_from_scan * pairs.centre_in_scan(), radius,
                                         free_scale, result.world_from_scan);
  return step.angle_rad < kSettledAngleRad && step.distance_m < kSettledDistanceM &&
         step.relative_scale * radius < kSettledDistanceM;
}

// Back to the start along what the pairs leave open; returns whether it was there already.
bool kept_start(IcpPairs& pairs, const Cutoff& cutoff, const Pose& start, Registration& result) {
  const double radius = result.world_from_scan.scale * pairs.radius_m();
  const StepSize back = return_along_open(pairs.plane_sums(cutoff.metres()), pairs.centre_in_scan(), radius,
                                          start, result.world_from_scan);
  return back.angle_rad < kSettledAngleRad && back.distance_m < kSettledDistanceM;
}

// The paper's step; returns whether the mean squared distance changed by less than tau since the last one.
bool point_step(IcpPairs& pairs, const Cutoff& cutoff, const IcpOptions& options, Registration& result) {
  const PointSums sums = pairs.point_sums(cutoff.metres());
  auto& history = result.rms_history_m;
  history.push_back(std::sqrt(sums.mean_square()));
  if (history.size() > 1) {
    const double last = history[history.size() - 2] * history[history.size() - 2];
    if (std::abs(last - sums.mean_square()) <= options.tau * last) return true;
  }
  result.world_from_scan = horn_pose(sums, result.world_from_scan.scale, options.free_scale);
  return false;
}

// The pairs within 5 cm, those the robust weights dropped included: on a proxy with displaced faces the
// inliers agree among themselves far better than with the truth.
struct Agreement {
  double overlap = 0;        // share of the area
  double mean_square = 0;    // of the heights, m2
  double superclusters = 0;  // effective number: (sum of areas)^2 / sum of squares
};

Agreement agreement(const PlanarSamples& samples, const std::vector<float>& distances,
                    const std::vector<float>& heights) {
  double total = 0, near = 0, square = 0, squared_areas = 0, of_this = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    // Samples come one supercluster after the other, each with its own normal.
    if (i > 0 && samples.normals[i] != samples.normals[i - 1]) {
      squared_areas += of_this * of_this;
      of_this = 0;
    }
    const double area = samples.points[i][3], height = heights[i];
    total += area;
    if (!(distances[i] < kOverlapM)) continue;
    near += area;
    of_this += area;
    square += area * height * height;
  }
  squared_areas += of_this * of_this;
  if (near == 0) return {};
  return {near / total, square / near, near * near / squared_areas};
}

// Everything said about the final pose, from the pairs under it.
void describe(IcpPairs& pairs, const PlanarSamples& samples, const IcpOptions& options, Cutoff& cutoff,
              Registration& result) {
  const bool plane = options.step == "plane";
  pairs.find(result.world_from_scan);
  const auto distances = pairs.distances(), heights = pairs.heights();
  const Agreement agreed = agreement(samples, distances, heights);
  result.overlap = agreed.overlap;
  if (!cutoff.update(plane ? heights : distances, pairs.areas())) return;
  const double radius = result.world_from_scan.scale * pairs.radius_m();
  const Vec3 pivot = result.world_from_scan * pairs.centre_in_scan();
  const PlaneSums sums = pairs.plane_sums(cutoff.metres());
  result.rms_m = std::sqrt(plane ? sums.mean_square() : pairs.point_sums(cutoff.metres()).mean_square());
  result.rms_history_m.push_back(result.rms_m);
  const OpenDirections open = degenerate_directions(sums, radius, options.free_scale);
  result.degenerate = open.in_words();
  result.only_slide = open.only_slide();
  const double variance =
      std::max({agreed.mean_square, sums.mean_square(), options.scale_floor_m * options.scale_floor_m});
  result.covariance = pose_covariance(sums, variance / std::max(agreed.superclusters, 1.0), pivot, radius,
                                      options.free_scale);
}

Registration iterate(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                     const Pose& start, const IcpOptions& options) {
  IcpPairs pairs(queue, samples, model, start, options);
  const bool plane = options.step == "plane";
  Cutoff cutoff(options);
  Registration result;
  result.world_from_scan = start;
  bool returned = false;
  while (!result.converged && result.iterations < options.max_iterations) {
    pairs.find(result.world_from_scan);
    if (!cutoff.update(plane ? pairs.heights() : pairs.distances(), pairs.areas())) {
      if (result.iterations == 0) fail_without_pairs(options);
      break;
    }
    const bool still = plane ? plane_step(pairs, cutoff, options.free_scale, result)
                             : point_step(pairs, cutoff, options, result);
    result.converged = still && cutoff.settled();
    if (result.converged && plane && !returned) {
      result.converged = kept_start(pairs, cutoff, start, result);
      returned = true;
    }
    ++result.iterations;
  }
  describe(pairs, samples, options, cutoff, result);
  return result;
}

}  // namespace

const std::vector<OptionRow<IcpOptions>>& icp_option_table() {
  using O = IcpOptions;
  // Every member spelled out, `choices` too: GCC 12 crashes on rows that leave it to its default.
  static const std::vector<OptionRow<IcpOptions>> table = {
      {"step", "", &O::step, 0, 0, "point-to-plane, or the paper's point-to-point", {"point", "plane"}},
      {"robust", "", &O::robust, 0, 0, "weights of the pairs", {"none", "tukey"}},
      {"gate_m", "m", &O::gate_m, 0, 1e6, "ignore pairs farther apart; 0 = no gate", {}},
      {"normal_deg", "deg", &O::normal_deg, 1, 180, "largest angle of compatible normals; 180 = any", {}},
      {"max_iterations", "", &O::max_iterations, 1, 10000, "steps after which to stop", {}},
      {"tau", "", &O::tau, 0, 1, "point step: relative change of the mean square at which to stop", {}},
      {"scale_floor_m", "m", &O::scale_floor_m, 1e-6, 1, "least scale of the robust weights", {}},
      {"max_samples", "samples", &O::max_samples, 0, 1e9, "planar samples used, by area; 0 = all", {}},
      {"seed", "", &O::seed, 0, 2147483647, "of the draw of samples", {}},
  };
  return table;
}

Registration register_to_model(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                               const Pose& start, const IcpOptions& options) {
  check(samples, start, options);
  Registration result = iterate(queue, samples, model, start, options);
  const auto& open = result.degenerate;
  if (std::find(open.begin(), open.end(), kFreeToScale) == open.end()) return result;
  // What goes with the scale, a place, went astray with it: once more with the start's.
  IcpOptions rigid = options;
  rigid.free_scale = false;
  result = iterate(queue, samples, model, start, rigid);
  result.degenerate.emplace_back(kFreeToScale);
  result.only_slide.reset();
  return result;
}

Registration assess_pose(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                         const Pose& pose, const IcpOptions& options) {
  check(samples, pose, options);
  IcpPairs pairs(queue, samples, model, pose, options);
  Cutoff cutoff(options);
  Registration result;
  result.world_from_scan = pose;
  result.converged = true;
  describe(pairs, samples, options, cutoff, result);
  return result;
}

}  // namespace hybrid::stages
