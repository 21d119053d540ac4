#include "stages/registration/scan_hypotheses.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/angles.hpp"
#include "stages/registration/automatic_words.hpp"
#include "stages/registration/line_of_places.hpp"

namespace hybrid::stages {
namespace {

// Beside all planar area this share counts for every direction: a window's frame says nothing alone.
constexpr double kLeastTells = 0.0005;
// Places on the line are compared first within overlap_m, then within these shares of it: what holds a scan
// along the line is little, and for robust ICP an outlier unless it starts within the noise. With at most so
// many samples of a scan.
constexpr double kFiner[] = {0.2, 0.04};
constexpr int kFinerSteps = 6;
constexpr std::size_t kSamplesOnLine = 2000;
// From there the gate need not be wide, in overlap_m.
constexpr double kGateOnLine = 4;
// Ends of ICP this near are one place.
constexpr double kOnePlace_m = 0.02, kOnePlaceDeg = 0.2;
// A line holds for hypotheses that lie on it, nearer than this share of its reach.
constexpr double kOnLine = 0.5;
// Where what is seen through is too little to contradict either of two places, as of a box turned by half or
// the sides of a church, whole planes or what is no plane contradict one: so much of either, and so many
// times as much as of the other; of what is no plane there must be some.
constexpr double kTimesBest = 4, kFreeThrough = 0.2, kFreeTells = 0.002;
// An eighth of the samples tells it, too, where there is so many times as much, and of these an eighth what
// is contradicted anyway.
constexpr double kFewTell = 2;

struct Against {
  double share = 0;  // seen through, of what bears on a shift along `direction`
  Vec3 direction = Vec3::UnitZ();
};

// The direction along which most is seen through.
Against against(const ComparedPlanes& area) {
  const double total = area.on.trace() + area.through.trace();
  if (!(total > 0)) return {};
  const Mat3 all = area.on + area.through + kLeastTells * total * Mat3::Identity();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Mat3> solver(area.through, all);
  return {solver.eigenvalues()(2), solver.eigenvectors().col(2).normalized()};
}

// Without what bears on a shift along the direction.
ComparedPlanes without(const ComparedPlanes& area, const Vec3& direction) {
  const Mat3 rest = Mat3::Identity() - direction * direction.transpose();
  return {rest * area.on * rest, rest * area.through * rest, 0};
}

bool is_one_place(const Pose& a, const Pose& b) {
  return difference(a, b).within(kOnePlace_m, kOnePlaceDeg * kDegree);
}

// Where an eighth of the samples ends from a hypothesis.
struct End {
  Pose hypothesis;
  ScanIcp found;
  std::vector<PlacedScan> on;
};

class Chooser {
 public:
  Chooser(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
          const PlaceTallies& tallies, const HypothesesOptions& options)
      : queue_(queue),
        scan_(scan),
        placed_(placed),
        tallies_(tallies),
        options_(options),
        few_(options.icp),
        on_line_(options.icp) {
    few_.few = on_line_.few = true;
    on_line_.gate_m = kGateOnLine * on_line_.overlap_m;
  }

  // Nothing where the scans contradict the hypothesis and the places beside it.
  std::optional<End> end_of(const Pose& hypothesis);
  // With all samples, on all scans.
  ScanIcp finish(const End& end);
  bool is_contradicted(const PlaceEvidence& found, double times = 1) const {
    return found.seen_through > times * options_.most_through ||
           against(found.planes).share > times * options_.most_along;
  }
  std::string doubt(const ScanIcp& found) const;
  bool is_held(const ScanIcp& found) const { return found.planes.weakest().share >= options_.least_held; }
  // Whether the scans contradict the one place where they do not contradict the other.
  bool is_ruled_out(const ScanIcp& other, const ScanIcp& best, double times = 1) const;
  // The place, or one beside it along what nothing holds, that is not ruled out; nothing where there is none.
  std::optional<Pose> room_at(const ScanIcp& other, const ScanIcp& best) const;

 private:
  struct Line {
    Pose pose;
    Vec3 direction;
  };
  int steps_on_line() const {
    return static_cast<int>(options_.reach_m / LineOfPlaces::step_m(few_.overlap_m));
  }
  bool free_tells(const ScanIcp& found) const { return found.free_m2 > kFreeTells * scan_.area_m2; }
  bool is_hopeless(const PlaceEvidence& found, const Vec3& direction, double times = 1) const;
  bool is_hopeless_by_fewest(const Pose& hypothesis) const;
  bool is_along(const Pose& a, const Pose& b, const Vec3& direction) const;
  bool is_on_line(const Pose& pose, const Vec3& direction) const;
  // Whether it is contradicted as a place of its own, then by how much more than a place may be.
  using Contradictions = std::pair<bool, double>;
  Contradictions contradictions(const ScanIcp& found) const;
  double least_contradicted_m(const LineOfPlaces& line, const std::vector<LineOfPlaces::Place>& places,
                              const std::vector<PlacedScan>& on) const;

  device::Queue& queue_;
  const IcpScan& scan_;
  const std::vector<PlacedScan>& placed_;
  const PlaceTallies& tallies_;  // of every hypothesis, by a sixty-fourth of the samples
  const HypothesesOptions& options_;
  ScanIcpOptions few_, on_line_;
  std::vector<Line> lines_;  // that were gone along
};

// Whether it is contradicted wherever it lies along the direction.
bool Chooser::is_hopeless(const PlaceEvidence& found, const Vec3& direction, double times) const {
  const ComparedPlanes rest = without(found.planes, direction);
  return rest.through.trace() > times * options_.most_through * (rest.on.trace() + rest.through.trace()) ||
         against(rest).share > times * options_.most_along;
}

bool Chooser::is_hopeless_by_fewest(const Pose& hypothesis) const {
  const PlaceEvidence& found = tallies_.of(hypothesis);
  return is_contradicted(found, kFewTell) && is_hopeless(found, against(found.planes).direction, kFewTell);
}

Chooser::Contradictions Chooser::contradictions(const ScanIcp& found) const {
  const double planes = found.planes.contradicted() / options_.most_contradicted;
  const double free = free_tells(found) ? found.free_seen_through / kFreeThrough : 0;
  return {is_contradicted(found), std::max(planes, free)};
}

bool Chooser::is_along(const Pose& a, const Pose& b, const Vec3& direction) const {
  const Vec3 apart = a.translation - b.translation;
  return (apart - direction.dot(apart) * direction).norm() < options_.icp.overlap_m &&
         difference(a, b).angle_rad < kOnePlaceDeg * kDegree;
}

bool Chooser::is_on_line(const Pose& pose, const Vec3& direction) const {
  return std::any_of(lines_.begin(), lines_.end(), [&](const Line& line) {
    return std::abs(line.direction.dot(direction)) >= std::cos(kDegree) &&
           std::abs(line.direction.dot(pose.translation - line.pose.translation)) <
               kOnLine * options_.reach_m &&
           is_along(pose, line.pose, line.direction);
  });
}

// Where nothing holds the scan along the line; the middle one of those that are contradicted equally little.
double Chooser::least_contradicted_m(const LineOfPlaces& line, const std::vector<LineOfPlaces::Place>& places,
                                     const std::vector<PlacedScan>& on) const {
  std::vector<double> shifts_m;
  std::optional<Contradictions> least;
  for (const auto& place : places) {
    const auto of = contradictions(compare_on_scans(queue_, scan_, on, line.at(place.shift_m), few_));
    if (least && *least < of) continue;
    if (least && of < *least) shifts_m.clear();
    least = of;
    shifts_m.push_back(place.shift_m);
  }
  return shifts_m[shifts_m.size() / 2];
}

std::optional<End> Chooser::end_of(const Pose& hypothesis) {
  if (is_hopeless_by_fewest(hypothesis)) return std::nullopt;
  End end{hypothesis, compare_on_scans(queue_, scan_, placed_, hypothesis, few_), {}};
  end.on = near_scans(placed_, end.found);  // ICP is on these, and so is the line of places beside it
  if (end.on.empty()) {
    if (is_contradicted(end.found)) return std::nullopt;
    return end;
  }
  const bool beside = is_contradicted(end.found);
  const Vec3 direction = beside ? against(end.found.planes).direction : end.found.planes.weakest().direction;
  if (beside && (is_hopeless(end.found, direction) || is_on_line(hypothesis, direction))) return std::nullopt;
  LineOfPlaces line(queue_, scan_, end.on, hypothesis, direction, kSamplesOnLine, options_.icp);
  double shift_m = 0;
  const double least_on_m2 = options_.least_held * end.found.planes.on.trace();
  if (beside) {
    lines_.push_back({hypothesis, direction});
    const auto places = line.places(0, few_.overlap_m, steps_on_line());
    const auto& best = LineOfPlaces::best(places);
    shift_m = best.bearing.on_m2 < least_on_m2 ? least_contradicted_m(line, places, end.on) : best.shift_m;
  }
  for (const double finer : kFiner) {
    const auto places = line.places(shift_m, finer * few_.overlap_m, kFinerSteps);
    const auto& best = LineOfPlaces::best(places);
    if (best.bearing.on_m2 >= least_on_m2) shift_m = best.shift_m;
  }
  end.found = register_to_scans(queue_, scan_, end.on, line.at(shift_m), on_line_);
  if (is_contradicted(end.found)) return std::nullopt;
  return end;
}

ScanIcp Chooser::finish(const End& end) {
  ScanIcpOptions all = on_line_;
  all.few = false;
  return register_to_some(queue_, scan_, end.on, placed_, end.found.icp.world_from_scan, all);
}

// Why nothing contradicts the pose's place, but it is not accepted; "" = it is.
std::string Chooser::doubt(const ScanIcp& found) const {
  if (found.icp.overlap < options_.least_overlap)
    return fmt::format("only {:.0f} % of the scan's area lie on surfaces of others, at least {:.0f} % should",
                       100 * found.icp.overlap, 100 * options_.least_overlap);
  if (is_contradicted(found)) {
    const Against most = against(found.planes);
    return fmt::format(
        "{:.1f} % of all planar area that can be compared are seen through, {:.0f} % of what bears on a "
        "shift along {}",
        100 * found.seen_through, 100 * most.share, vector_in_words(most.direction));
  }
  if (const double share = found.planes.weakest().share; share < options_.least_held)
    return fmt::format(
        "of the planar area that lies on surfaces of others {:.2f} % hold the scan along its weakest "
        "direction, at least {:.2f} % should",
        100 * share, 100 * options_.least_held);
  if (const double share = found.planes.contradicted(); share > options_.most_contradicted)
    return fmt::format(
        "planes of {:.2f} % of the planar area that can be compared are seen through, at most {:.2f} % "
        "should: has something moved, or is it another place that is alike?",
        100 * share, 100 * options_.most_contradicted);
  if (const double share = found.planes.beside(); share > options_.most_beside)
    return fmt::format(
        "planes of {:.2f} % of the planar area that can be compared lie beside others', at most {:.2f} % "
        "should: is it another place that is alike?",
        100 * share, 100 * options_.most_beside);
  if (options_.needs_free && !free_tells(found))
    return "too little of what is no plane can be compared: another place that is alike would fit as well";
  if (found.free_seen_through > options_.most_free && free_tells(found))
    return fmt::format(
        "{:.0f} % of what is no plane are seen through, at most {:.0f} % should: is it another place that is "
        "alike?",
        100 * found.free_seen_through, 100 * options_.most_free);
  if (!found.icp.degenerate.empty()) return "it is " + found.icp.degenerate.front();
  return "";
}

bool Chooser::is_ruled_out(const ScanIcp& other, const ScanIcp& best, double times) const {
  if (other.planes.contradicted() >
      times * std::max(options_.most_contradicted, kTimesBest * best.planes.contradicted()))
    return true;
  return free_tells(other) && free_tells(best) &&
         other.free_seen_through > times * std::max(kFreeThrough, kTimesBest * best.free_seen_through);
}

// A place that nothing holds along a line stands for all on it, as it is hardly the right one of them: it is
// ruled out where all of them are.
std::optional<Pose> Chooser::room_at(const ScanIcp& other, const ScanIcp& best) const {
  Pose place = other.icp.world_from_scan;
  const bool slides = !is_held(best);  // and is refused for that
  if (slides && is_along(place, best.icp.world_from_scan, best.planes.weakest().direction))
    return std::nullopt;
  if (!is_ruled_out(other, best)) return place;
  if (is_held(other) || slides) return std::nullopt;
  const Vec3 step = LineOfPlaces::step_m(few_.overlap_m) * other.planes.weakest().direction;
  for (int k = -steps_on_line(); k <= steps_on_line(); ++k) {
    place.translation = other.icp.world_from_scan.translation + k * step;
    const ScanIcp found = compare_on_scans(queue_, scan_, placed_, place, options_.icp);
    if (!is_contradicted(found) && !is_ruled_out(found, best)) return place;
  }
  return std::nullopt;
}

}  // namespace

ChosenHypothesis choose_hypothesis(device::Queue& queue, const IcpScan& scan,
                                   const std::vector<PlacedScan>& placed, const std::vector<Pose>& hypotheses,
                                   PlaceTallies& tallies, const HypothesesOptions& options) {
  ScanIcpOptions fewest = options.icp;
  fewest.fewest = true;
  tallies.ask(queue, scan, placed, hypotheses, fewest);
  Chooser chooser(queue, scan, placed, tallies, options);
  ChosenHypothesis chosen;
  chosen.tried = static_cast<int>(hypotheses.size());
  std::vector<End> ends;
  for (const Pose& hypothesis : hypotheses) {
    auto end = chooser.end_of(hypothesis);
    if (!end) continue;
    const bool known = std::any_of(ends.begin(), ends.end(), [&](const End& other) {
      return is_one_place(other.found.icp.world_from_scan, end->found.icp.world_from_scan);
    });
    if (!known) ends.push_back(std::move(*end));
  }
  if (ends.empty()) {
    chosen.reason =
        fmt::format("the scans that have a pose contradict all of its {} hypotheses", chosen.tried);
    return chosen;
  }
  const auto sort = [&] {
    std::stable_sort(ends.begin(), ends.end(),
                     [](const End& a, const End& b) { return a.found.icp.overlap > b.found.icp.overlap; });
  };
  sort();
  const ScanIcp first = ends.front().found;
  std::erase_if(ends, [&](const End& end) {
    return chooser.is_held(end.found) && chooser.is_ruled_out(end.found, first, kFewTell);
  });
  for (End& end : ends) end.found = chooser.finish(end);
  sort();
  // The other side of a church may overlap more, and be contradicted where the right one is not.
  const auto rival_of = [&](const End& best) {
    std::optional<Pose> rival;
    for (const End& other : ends)
      if (!rival && &other != &best &&
          other.found.icp.overlap >= options.least_rival * best.found.icp.overlap)
        rival = chooser.room_at(other.found, best.found);
    return rival;
  };
  auto best = ends.begin();
  auto rival = rival_of(*best);
  for (auto other = best + 1; rival && other != ends.end(); ++other)
    if (!rival_of(*other)) {
      best = other;
      rival.reset();
    }
  chosen.has_rival = rival.has_value();
  chosen.found_any = true;
  chosen.start = best->hypothesis;
  chosen.found = best->found;
  chosen.along = against(best->found.planes).share;
  chosen.held = best->found.planes.weakest().share;
  chosen.reason = chosen.has_rival
                      ? fmt::format("the scans that have a pose contradict neither one place nor another: {}",
                                    motion_in_words(best->found.icp.world_from_scan, *rival))
                      : chooser.doubt(best->found);
  chosen.accepted = chosen.reason.empty();
  return chosen;
}

}  // namespace hybrid::stages
