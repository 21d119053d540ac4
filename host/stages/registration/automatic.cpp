#include "stages/registration/automatic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "stages/registration/automatic_checks.hpp"
#include "stages/registration/automatic_search.hpp"
#include "stages/registration/automatic_words.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kNamedRivals = 8;

// Poses this near are one hypothesis, of which the best is looked at: ICP decides between them.
constexpr double kOneHypothesis_m = 0.3;

bool is_near(const ScanEvidence& scan, const Finalist& a, const Finalist& b) {
  return same_place(scan, a.fit.world_from_scan, b.fit.world_from_scan, kOneHypothesis_m);
}

std::vector<RivalPose> rivals_of(const ScanEvidence& scan, const Search& search, std::size_t chosen,
                                 const AutomaticOptions& options) {
  std::vector<RivalPose> rivals;
  const Finalist& best = search.finalists[chosen];
  for (std::size_t k = 0; k < search.finalists.size(); ++k) {
    if (k == chosen || is_near(scan, best, search.finalists[k])) continue;
    RivalPose rival;
    rival.world_from_scan = search.finalists[k].fit.world_from_scan;
    rival.words = motion_in_words(best.fit.world_from_scan, rival.world_from_scan);
    rival.comparison = compare(scan.rays, best.lines, search.finalists[k].lines);
    rival.strength = strength(rival.comparison, margin_rule(options));
    rivals.push_back(std::move(rival));
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const RivalPose& a, const RivalPose& b) { return a.strength < b.strength; });
  return rivals;
}

constexpr double kUpright = 1e-6;  // of equals the one that stands

// The pose whose weakest comparison is strongest: the score alone lets one large doubtful face decide.
std::size_t choose(const ScanEvidence& scan, const Search& search) {
  std::size_t best = 0;
  double best_strength = -std::numeric_limits<double>::infinity();
  // Poses far below the best score cannot win.
  for (std::size_t k = 0; k < search.finalists.size(); ++k) {
    if (search.finalists[k].shares.score < search.finalists[0].shares.score - 0.1) continue;
    double weakest = std::numeric_limits<double>::infinity();
    for (std::size_t l = 0; l < search.finalists.size() && weakest + kUpright > best_strength; ++l)
      if (l != k && !is_near(scan, search.finalists[k], search.finalists[l]))
        weakest =
            std::min(weakest, compare(scan.rays, search.finalists[k].lines, search.finalists[l].lines).gap());
    weakest += kUpright * search.finalists[k].fit.world_from_scan.rotate(Vec3::UnitZ()).z();
    if (weakest > best_strength) {
      best_strength = weakest;
      best = k;
    }
  }
  return best;
}

constexpr double kSeenShare = 0.002;
constexpr double kPlaneShare = 0.03, kSmallPlaneShare = 0.01;
// Cosines of two planes that are neither nearly parallel nor nearly at right angles, as any room's are; and
// how little all may be turned for the angle between these to speak for this room.
constexpr double kLeastOblique = 0.1, kMostOblique = 0.99, kTurned_rad = 0.5 * std::numbers::pi / 180;

// What lies on one face or plane of the model.
struct Held {
  double area_m2 = 0, moment_m3 = 0;  // area; times the signed distance from the plane
  Vec3 normal = Vec3::Zero();         // of the scan's planes: sum over the area
  double offset_m() const { return moment_m3 / area_m2; }
};

// By face of the model.
std::map<std::uint32_t, Held> held_by_face(const ScanEvidence& scan, const Finalist& pose,
                                           const ModelShapes& model) {
  std::map<std::uint32_t, Plane> planes;
  for (const FaceShape& face : model.faces) planes[face.face] = face.plane;
  std::map<std::uint32_t, Held> by_face;
  for (std::size_t k = 0; k < pose.lines.size(); ++k) {
    if (pose.lines[k].sight != Sight::supported) continue;
    const SightRay& ray = scan.rays[k];
    Held& held = by_face[pose.lines[k].face];
    held.area_m2 += ray.area_m2;
    held.normal += ray.area_m2 * pose.fit.world_from_scan.rotate(ray.normal);
    if (const auto plane = planes.find(pose.lines[k].face); plane != planes.end()) {
      const Vec3 point = pose.fit.world_from_scan * Vec3(ray.range_m * ray.direction);
      held.moment_m3 += ray.area_m2 * plane->second.distance(point);
    }
  }
  return by_face;
}

// The planes of the model that hold the scan, small ones counted half, and how far they are off.
void count_planes(const std::map<std::uint32_t, Held>& by_face, const ModelShapes& model, double area_m2,
                  AutomaticAlignment& result) {
  std::map<std::uint32_t, Held> by_plane;
  for (const FaceShape& face : model.faces)
    if (const auto held = by_face.find(face.face); held != by_face.end()) {
      by_plane[face.plane_index].area_m2 += held->second.area_m2;
      by_plane[face.plane_index].moment_m3 += held->second.moment_m3;
      by_plane[face.plane_index].normal += held->second.normal;
    }
  std::vector<Vec3> large;
  bool oblique = false;
  for (const auto& [plane, held] : by_plane) {
    if (held.area_m2 < kSmallPlaneShare * area_m2) continue;
    result.planes += held.area_m2 < kPlaneShare * area_m2 ? 0.5 : 1;
    result.farthest_m = std::max(result.farthest_m, std::abs(held.offset_m()));
    if (held.area_m2 < kPlaneShare * area_m2) continue;
    const Vec3& normal = model.planes[plane].plane.normal;
    result.farthest_rad =
        std::max(result.farthest_rad, std::atan2(held.normal.cross(normal).norm(), held.normal.dot(normal)));
    for (const Vec3& other : large) {
      const double cosine = std::abs(other.dot(normal));
      oblique = oblique || (cosine > kLeastOblique && cosine < kMostOblique);
    }
    large.push_back(normal);
  }
  if (oblique && result.farthest_rad < kTurned_rad) result.planes += 1;
}

}  // namespace

const std::vector<OptionRow<AutomaticOptions>>& automatic_option_table() {
  using O = AutomaticOptions;
  static const std::vector<OptionRow<AutomaticOptions>> table = {
      {"levelled", "", &O::levelled, 0, 0, "scanners stood upright; default: [scene] levelled", {}},
      {"automatic_rays", "", &O::rays, 200, 1e6, "lines of sight a pose is judged by", {}},
      {"automatic_tolerance_m", "m", &O::tolerance_m, 0.001, 10, "a sample this near a face supports it", {}},
      {"automatic_clear_m", "m", &O::clear_m, 0.002, 20, "beyond this a sample contradicts a face", {}},
      {"automatic_face_offset_m", "m", &O::face_offset_m, 0, 10, "each face may be this far off", {}},
      {"automatic_gap", "", &O::least_gap, 0, 1, "area that must speak against every rival, share", {}},
      {"automatic_consistency", "", &O::least_consistency, 0, 1, "how far it must all point one way", {}},
      {"automatic_rest", "", &O::least_without_largest, 0, 1, "the gap without its largest plane", {}},
      {"automatic_firm", "", &O::least_firm, 0, 1, "or what one plane says firmly", {}},
      {"automatic_single", "", &O::least_single, 0, 1, "or one plane this large", {}},
      {"automatic_support", "", &O::least_support, 0, 1, "planar area that must lie on faces, share", {}},
      {"automatic_doubt", "", &O::most_doubt, 0, 1e6, "planes off faces against planes on them", {}},
      {"automatic_planes", "", &O::least_planes, 0, 100, "planes of the model that must hold the scan", {}},
      {"automatic_through", "", &O::most_through, 0, 1, "planar area that may be seen through faces", {}},
      {"automatic_hold", "", &O::least_hold, 0, 1, "least resistance along any direction, share", {}},
  };
  return table;
}

MarginRule margin_rule(const AutomaticOptions& options) {
  return {options.least_gap, options.least_consistency, options.least_without_largest, options.least_firm,
          options.least_single};
}

AutomaticAlignment align_automatically(device::Queue& queue, const ScanEvidence& scan,
                                       const ProxyModel& model, const AutomaticOptions& options) {
  AutomaticAlignment result;
  const ModelShapes& shapes = model.shapes();
  result.reason = unsuitable(scan, shapes, options);
  if (!result.reason.empty()) return result;

  SightCaster caster(queue, model);
  Search search = search_poses(caster, scan, shapes, 1, options);
  result.rotations = search.rotations;
  result.guesses = search.guesses;
  // What is wrong with a model as a whole; a scan has its faces the right way round.
  const auto diagnosis = [&](double supported) {
    return options.of_scan ? "" : diagnose_model(queue, scan, model.polygons(), supported, options);
  };
  if (search.finalists.empty()) {
    result.reason = diagnosis(0);
    if (result.reason.empty()) result.reason = nothing_fits(options);
    return result;
  }
  const Pose first = search.finalists[0].fit.world_from_scan;
  add_symmetric_rivals(caster, scan, shapes, model.motions(options.levelled), first, options, search);
  const std::size_t chosen = choose(scan, search);
  const Finalist& best = search.finalists[chosen];
  result.finalists = static_cast<int>(search.finalists.size());
  result.world_from_scan = best.fit.world_from_scan;
  result.has_pose = true;
  result.shares = best.shares;
  const auto by_face = held_by_face(scan, best, shapes);
  for (const auto& [face, held] : by_face)
    if (held.area_m2 >= kSeenShare * scan.area_m2) result.faces.push_back(face);
  count_planes(by_face, shapes, scan.area_m2, result);
  result.doubt = doubt(scan, best.lines);
  result.rivals = rivals_of(scan, search, chosen, options);
  result.close_rivals = std::count_if(result.rivals.begin(), result.rivals.end(),
                                      [](const RivalPose& rival) { return rival.strength < 1; });
  result.hypotheses = {result.world_from_scan};
  for (const RivalPose& rival : result.rivals)
    (rival.strength < 1 ? result.hypotheses : result.beaten).push_back(rival.world_from_scan);
  result.margin = 1;
  for (const RivalPose& rival : result.rivals)
    result.margin = std::min(result.margin, rival.comparison.gap());
  result.reason = doubts(best.fit, result, options);
  if (result.reason.empty()) {
    result.reason = doubts_by_rivals(result, options);
    result.only_rivals = !result.reason.empty();
  }
  result.accepted = result.reason.empty();
  if (!result.accepted)
    if (const auto words = diagnosis(best.shares.supported); !words.empty()) result.reason = words;
  if (result.rivals.size() > kNamedRivals) result.rivals.resize(kNamedRivals);
  return result;
}

AutomaticAlignment inverted(AutomaticAlignment alignment) {
  alignment.back = !alignment.back;
  const auto invert = [](Pose& pose) { pose = pose.inverse(); };
  invert(alignment.world_from_scan);
  if (alignment.by_samples) invert(alignment.by_samples->best_by_planes);
  for (RivalPose& rival : alignment.rivals) invert(rival.world_from_scan);
  for (auto* poses : {&alignment.hypotheses, &alignment.beaten, &alignment.uncontradicted})
    std::for_each(poses->begin(), poses->end(), invert);
  return alignment;
}

}  // namespace hybrid::stages
