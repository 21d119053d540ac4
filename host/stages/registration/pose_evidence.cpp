#include "stages/registration/pose_evidence.hpp"

#include <cmath>

#include "stages/registration/automatic_checks.hpp"
#include "stages/registration/automatic_search.hpp"
#include "stages/registration/automatic_words.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFurniture = 0.5;   // what lies in front of faces counts so much against the pose
constexpr double kHardlyAny = 0.01;  // of the planar area on faces
constexpr double kMostThroughUndetermined = 0.2;  // where the start's place along a direction was kept
// In models this many times larger than the scan, or smaller, no more than this may contradict the pose.
constexpr double kOddRatio = 100, kMostOfOddSize = 0.3;

// A pose that so much contradicts is compared with those a search finds; one is better that lays so much more
// on faces.
constexpr double kSuspicious = 0.2, kBetterSupported = 0.15;

SightOptions sights_of(const AutomaticOptions& options, double scale) {
  SightOptions sight = sight_options(options);
  sight.recesses = false;  // nothing is compared with rivals
  for (double* distance : {&sight.tolerance_m, &sight.clear_m, &sight.offset_m}) *distance *= scale;
  return sight;
}

std::string contradiction(const SightShares& shares, const Registration& icp, const IcpOptions& icp_options,
                          const AutomaticOptions& options, double scale, bool odd_size) {
  const double most_rms_m = 2 * options.clear_m * scale;
  if (icp_options.step == "plane" && icp_options.robust == "tukey" && icp.rms_m > most_rms_m)
    return fmt::format("residuals of {:.2f} m rms, at most {:.2f} m may be", icp.rms_m, most_rms_m);
  if (shares.supported < kHardlyAny) return "hardly any planar area lies on the model's faces";
  if (shares.through > options.most_through)
    return fmt::format("more than {:.0f} % of the planar area are seen through faces",
                       100 * options.most_through);
  if (!icp.degenerate.empty() && shares.through > kMostThroughUndetermined)
    return fmt::format(
        "it is undetermined ({}), and more than {:.0f} % of the planar area are seen through faces",
        icp.degenerate[0], 100 * kMostThroughUndetermined);
  const double off = shares.through + shares.behind + kFurniture * shares.in_front;
  if (shares.supported < options.least_support * (shares.supported + off))
    return fmt::format("less than {:.0f} % of what can be compared lies on faces",
                       100 * options.least_support);
  if (odd_size && shares.through + shares.behind + shares.in_front > kMostOfOddSize)
    return fmt::format("more than {:.0f} % of the planar area contradict a model of quite another size",
                       100 * kMostOfOddSize);
  return "";
}

// Another pose that clearly explains the scan better: "" or how it differs, in words. Costs a search.
std::string better_pose(SightCaster& caster, const ScanEvidence& scan, const ProxyModel& model,
                        const Pose& pose, const std::vector<SightLine>& lines, double supported,
                        const AutomaticOptions& options) {
  const Search search = search_poses(caster, scan, model.shapes(), 1, options);
  for (const Finalist& other : search.finalists)
    if (other.shares.supported > supported + kBetterSupported &&
        strength(compare(scan.rays, other.lines, lines), margin_rule(options)) >= 1)
      return fmt::format("another pose lays {:.0f} % of the planar area on faces: {}",
                         100 * other.shares.supported, motion_in_words(pose, other.fit.world_from_scan));
  return "";
}

}  // namespace

PoseEvidence judge_pose(device::Queue& queue, const ScanEvidence& scan, const ProxyModel& model,
                        const Registration& icp, const IcpOptions& icp_options,
                        const AutomaticOptions& options) {
  const double scale = options.free_scale ? icp.world_from_scan.scale : 1;
  SightCaster caster(queue, model);
  const Pose& pose = icp.world_from_scan;
  const auto lines = caster.cast(scan.rays, pose, sights_of(options, scale));
  PoseEvidence evidence;
  const SightShares& shares = evidence.shares = shares_of(scan.rays, lines);
  evidence.contradiction = contradiction(shares, icp, icp_options, options, scale,
                                         !odd_size(scan, model.shapes(), pose.scale, kOddRatio).empty());
  if (evidence.contradiction.empty() && shares.through + shares.behind + shares.in_front > kSuspicious &&
      std::abs(pose.scale - 1) < kRounded && unsuitable(scan, model.shapes(), options).empty())
    evidence.contradiction = better_pose(caster, scan, model, pose, lines, shares.supported, options);
  return evidence;
}

}  // namespace hybrid::stages
