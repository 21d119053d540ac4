#include "batch/registration/scan_to_scan.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace hybrid::batch {
namespace {

constexpr int kSamples = 40000;  // of each kind
// Of what lies on surfaces or is seen through: more contradicts a pose. Over random rooms right ones have
// 0.02 at most, wrong ones 0.08 and more (the test ScanIcp). Where little holds the scan, as through a
// church's door, right ones have 0.012 at most, wrong ones 0.04 and more.
constexpr double kMostSeenThrough = 0.05, kMostWhereWeak = 0.025;
// A pose that planes alone do not tell from rivals is told from them where it has so much at most, and each
// rival so many times more.
constexpr double kMostOfBest = 0.02, kTimesBest = 4;
// Where planes lay a scan on one other with less than this of it on the other's, or so far off, samples are
// not asked: of one place planes lie within 2 mm, of rooms of nearly one size centimetres beside each other.
constexpr double kLeastSupport = 0.2, kMostOff_m = 0.02;
// So many times as much as that an eighth of the samples tells, too.
constexpr double kFewTell = 2;
// From farther off ICP finds some other place; from nearer by this factor where little holds the scan.
constexpr double kFarthestMoved_m = 2, kFarthestDeg = 40, kNearer = 0.3;
// Where the end of ICP is not plain, with nearly all that lies on others within kTight times overlap_m of
// them and hardly anything seen through, it starts beside that, too, and takes what is better by kClearly, so
// many times. Of depth frames and rooms right ends have shares of 0.96 and more, of frames that slid along a
// wall 0.90 at most or 0.02 seen through.
constexpr double kTight = 0.2, kPlainShare = 0.95, kPlainThrough = 0.005, kClearly = 0.02;
constexpr int kRounds = 3;
// An eighth of the samples says first whether that is worth it, with so much less that is clear; and of a
// place with so much seen through, far from right ones, whether ICP is to go on there.
constexpr double kFewClearly = 0.01, kHopelessThrough = 0.2;
// Where little holds the scan ICP must come back from so far beside what it found, in overlap_m and turned
// about each axis; to within so much.
constexpr double kBeside = 3, kBesideDeg = 2, kBack = 0.4, kBackDeg = 0.2;
// Scans of one place lie on each other within their noise: 0.3 to 1 times it in rooms and churches of
// hybrid-synth, 5 where the instrument is not calibrated, 10 where two rooms are alike within centimetres.
constexpr double kTimesNoise = 4, kFarOff_m = 0.005, kLeastNoise_m = 1e-4;
constexpr double kReach = 2;  // of distances that are measured, in overlap_m

bool is_weak(const stages::ScanIcp& found) {
  return largest_overlap(found) < kFirmOverlap;
}

bool is_hopeless(const stages::ScanIcp& found) {
  return found.seen_through > kHopelessThrough;
}

std::string contradiction_of(const stages::ScanIcp& found, const Pose& start) {
  const bool weak = is_weak(found);
  const double most = weak ? kMostWhereWeak : kMostSeenThrough;
  if (found.seen_through > most)
    return fmt::format("more than {:.1f} % are seen through{}", 100 * most,
                       weak ? ", where little holds the scan" : "");
  const auto moved = difference(start, found.icp.world_from_scan);
  const double factor = weak ? kNearer : 1;
  if (!moved.within(factor * kFarthestMoved_m, factor * kFarthestDeg * kDegree))
    return fmt::format("it lies {:.2f} m and {:.1f} degrees from it", moved.distance_m,
                       moved.angle_rad / kDegree);
  return "";
}

// Six starts around a pose: along each axis of the world, and turned about it.
std::vector<Pose> beside(const Pose& pose, const Vec3& centre, double distance_m) {
  std::vector<Pose> starts;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 along = sign * Vec3::Unit(axis);
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(kBesideDeg * kDegree, along));
      Pose start = pose;
      start.rotation = (turn * pose.rotation).normalized();
      start.translation = pose * centre - start.rotate(start.scale * centre) + distance_m * along;
      starts.push_back(start);
    }
  return starts;
}

}  // namespace

double largest_overlap(const stages::ScanIcp& found) {
  double largest = 0;
  for (const auto& other : found.others) largest = std::max(largest, other.overlap);
  return largest;
}

const std::string& OnScans::nearest() const {
  std::size_t best = 0;
  for (std::size_t k = 1; k < others.size(); ++k)
    if (icp.others[k].on_m2 > icp.others[best].on_m2) best = k;
  return others[best];
}

ScanToScan::ScanToScan(device::Queue& queue, const StageOptions& options,
                       const std::vector<ScanProduct>& products)
    : queue_(queue),
      options_(options),
      products_(products),
      scans_(products.size()),
      tallies_(products.size()) {
  // The scene's size is in what is near a face and clear of it.
  icp_.overlap_m = options.alignment.tolerance_m;
  icp_.clear_m = options.alignment.clear_m;
  icp_.gate_m = 20 * icp_.overlap_m;
  icp_.least_gate_m = 0.4 * icp_.overlap_m;
  few_ = icp_;
  few_.few = true;
}

const stages::IcpScan& ScanToScan::scan(std::size_t i) {
  if (!scans_[i]) {
    const ScanProduct& product = products_[i];
    const int most = options_.icp.max_samples;
    scans_[i] = std::make_unique<stages::IcpScan>(
        queue_,
        stages::choose_scan_samples(product.image, product.segmentation, product.stray,
                                    most > 0 ? std::min(most, kSamples) : kSamples, options_.icp.seed),
        product.image, product.segmentation, product.stray);
  }
  return *scans_[i];
}

ScanToScan::Others ScanToScan::others_than(std::size_t i, const Registrations& registrations, bool firm) {
  Others others;
  for (std::size_t k = 0; k < registrations.size(); ++k) {
    if (k == i || !registrations[k] || (firm && registrations[k]->slides())) continue;
    others.scans.push_back({&scan(k), registrations[k]->world_from_scan()});
    others.ids.push_back(products_[k].id);
  }
  return others;
}

stages::ScanIcp ScanToScan::best_from(std::size_t i, const Others& others, const Pose& start) {
  stages::ScanIcpOptions tight = icp_;
  tight.overlap_m *= kTight;
  struct End {
    stages::ScanIcp found;
    double close = 0;  // share of the scan's area that lies closely on the others
    // Walls alone let a scan slide along them; other things then lie beside their own.
    double score() const { return close - found.seen_through; }
    bool is_plain() const {
      return close >= kPlainShare * found.icp.overlap && found.seen_through <= kPlainThrough;
    }
  };
  const auto end_of = [&](const Pose& from, const stages::ScanIcpOptions& how) {
    End end{stages::register_to_scans(queue_, scan(i), others.scans, from, how)};
    for (int more = 0; more < kRounds && !end.found.icp.converged && !is_hopeless(end.found); ++more)
      end.found =
          stages::register_to_scans(queue_, scan(i), others.scans, end.found.icp.world_from_scan, how);
    tight.few = how.few;
    end.close = stages::compare_on_scans(queue_, scan(i), others.scans, end.found.icp.world_from_scan, tight)
                    .icp.overlap;
    return end;
  };
  End best = end_of(start, icp_);
  for (int round = 0; round < kRounds && !best.is_plain(); ++round) {
    const double before = best.score();
    // Where little holds the scan all samples count.
    const bool by_few = !is_weak(best.found) || is_hopeless(best.found);
    for (const Pose& from :
         beside(best.found.icp.world_from_scan, scan(i).centre, kBeside * icp_.overlap_m)) {
      if (best.is_plain()) break;
      if (by_few && end_of(from, few_).score() < best.score() + kFewClearly) continue;
      if (End other = end_of(from, icp_); other.score() >= best.score() + kClearly) best = std::move(other);
    }
    if (!(best.score() > before)) break;
  }
  return std::move(best.found);
}

std::string ScanToScan::rival_of(std::size_t i, const Others& others, const Pose& found) {
  for (const Pose& start : beside(found, scan(i).centre, kBeside * icp_.overlap_m)) {
    const auto rival = stages::register_to_scans(queue_, scan(i), others.scans, start, icp_);
    const auto apart = difference(found, rival.icp.world_from_scan);
    if (apart.within(kBack * icp_.overlap_m, kBackDeg * kDegree)) continue;
    if (!contradiction_of(rival, found).empty()) continue;
    return fmt::format(
        "little holds the scan, and from beside it ICP finds another, {:.2f} m and {:.1f} degrees away, "
        "which the scans contradict no more",
        apart.distance_m, apart.angle_rad / kDegree);
  }
  return "";
}

std::optional<OnSlide> ScanToScan::hold_slide(std::size_t i, const Registrations& registrations) {
  const Others others = others_than(i, registrations, true);
  if (others.scans.empty()) return std::nullopt;
  const ScanRegistration& one = *registrations[i];
  stages::SlideOptions how;
  how.icp = icp_;
  how.reach_m = options_.joint_poses.reach_m;
  return OnSlide{
      stages::slide_on_scans(queue_, scan(i), others.scans, one.world_from_scan(), *one.icp.only_slide, how),
      others.ids};
}

ScanToScan::Laid ScanToScan::lay_from(std::size_t i, const Pose& start, const Registrations& registrations) {
  Others others = others_than(i, registrations);
  auto found = best_from(i, others, start);
  std::string contradiction = contradiction_of(found, start);
  if (contradiction.empty() && is_weak(found)) contradiction = rival_of(i, others, found.icp.world_from_scan);
  return {{"", std::move(found), std::move(others.ids)}, std::move(contradiction)};
}

ScanToScan::Look ScanToScan::look(std::size_t i, const Pose& pose, const Registrations& registrations) {
  Others others = others_than(i, registrations);
  auto found = stages::compare_on_scans(queue_, scan(i), others.scans, pose, icp_);
  double through_m2 = 0;
  for (const auto& other : found.others) through_m2 += other.through_m2;
  const double area_m2 = scan(i).area_m2;
  return {{"", std::move(found), std::move(others.ids)}, area_m2 > 0 ? through_m2 / area_m2 : 0};
}

void ScanToScan::judge(std::size_t i, std::size_t other, stages::AutomaticAlignment& found) {
  if (found.accepted || found.only_rivals)
    judge_by_planes(i, other, found);
  else if (found.has_pose && found.shares.supported >= kLeastSupport && found.farthest_m <= kMostOff_m)
    judge_by_samples(i, other, found);
}

void ScanToScan::judge_by_samples(std::size_t i, std::size_t other, stages::AutomaticAlignment& found) {
  std::vector<Pose> places = found.hypotheses;
  places.insert(places.end(), found.beaten.begin(), found.beaten.end());
  stages::PairPlaceOptions options;
  options.icp = icp_;
  const auto told = stages::tell_places(queue_, scan(i), {&scan(other), Pose()}, places, options);
  found.uncontradicted = told.uncontradicted;
  if (!told.fits) return;
  const stages::ScanIcp& best = told.open.front();
  found.by_samples = {found.reason, found.world_from_scan, best.free_seen_through};
  found.seen_through = best.seen_through;
  found.world_from_scan = best.icp.world_from_scan;
  found.hypotheses.clear();
  for (const stages::ScanIcp& one : told.open) found.hypotheses.push_back(one.icp.world_from_scan);
  found.accepted = told.is_told();
  found.only_rivals = !found.accepted;
  found.reason = found.accepted ? ""
                                : fmt::format(
                                      "its planes do not tell its place, and what is no plane fits {} "
                                      "places: one scan does not tell",
                                      told.open.size());
}

void ScanToScan::judge_by_planes(std::size_t i, std::size_t other, stages::AutomaticAlignment& found) {
  const std::vector<stages::PlacedScan> placed = {{&scan(other), Pose()}};
  const auto best = stages::compare_on_scans(queue_, scan(i), placed, found.world_from_scan, icp_);
  found.seen_through = best.seen_through;
  if (const auto words = contradiction_of(best, found.world_from_scan); !words.empty()) {
    found.accepted = false;
    found.reason = fmt::format(
        "its planes fit, but {} ({:.1f} % of all that can be compared): is it of another "
        "place that is alike?",
        words, 100 * best.seen_through);
    return;
  }
  // Then it is as likely of another place that is alike.
  if (stages::alike_through(best) > stages::PairPlaceOptions().most_alike_through) {
    if (!found.accepted) return;
    found.accepted = false;
    found.only_rivals = true;
    found.reason = fmt::format(
        "its planes fit, but {:.1f} % of all that can be compared are seen through, {:.1f} % of what is no "
        "plane: it may be of another place that is alike, and one scan does not tell",
        100 * best.seen_through, 100 * best.free_seen_through);
    return;
  }
  if (found.accepted || is_weak(best) || best.seen_through > kMostOfBest ||
      found.close_rivals > std::ssize(found.rivals))
    return;
  for (std::ptrdiff_t k = 0; k < found.close_rivals; ++k) {
    // At its best, as the search may have left it decimetres off.
    stages::RivalPose& rival = found.rivals[static_cast<std::size_t>(k)];
    const double least = std::max(kMostSeenThrough, kTimesBest * best.seen_through);
    const auto seen_from = [&](const stages::ScanIcpOptions& how) {
      return stages::register_to_scans(queue_, scan(i), placed, rival.world_from_scan, how).seen_through;
    };
    rival.seen_through = seen_from(few_);
    if (rival.seen_through <= kFewTell * least) rival.seen_through = seen_from(icp_);
    if (rival.seen_through <= least) return;
  }
  found.accepted = true;
  found.reason.clear();
}

ScanToScan::Chosen ScanToScan::choose(std::size_t i, const std::vector<Pose>& hypotheses,
                                      const Registrations& registrations, double least_rival, bool doubted) {
  Others others = others_than(i, registrations);
  stages::HypothesesOptions options;
  options.least_rival = least_rival;
  options.icp = icp_;
  options.reach_m = icp_.gate_m;
  if (doubted) {
    const stages::PairPlaceOptions pair;
    options.most_free = pair.most_free_through;
    options.most_beside = pair.most_beside;
    options.needs_free = true;
  }
  return {stages::choose_hypothesis(queue_, scan(i), others.scans, hypotheses, tallies_[i], options),
          std::move(others.ids)};
}

std::vector<PossiblePlace> ScanToScan::best_places(std::size_t i, const std::vector<Pose>& places,
                                                   const Registrations& registrations, std::size_t most) {
  const Others others = others_than(i, registrations);
  std::vector<PossiblePlace> best;
  for (const stages::ScanIcp& one :
       stages::likely_places(queue_, scan(i), others.scans, places, most, few_, kHopelessThrough))
    best.push_back(
        {one.icp.world_from_scan,
         fmt::format("{:.0f} % of it lie on other scans, most on scan {}, and of all that can be "
                     "compared {:.1f} % are seen through",
                     100 * one.icp.overlap, OnScans{"", one, others.ids}.nearest(), 100 * one.seen_through)});
  return best;
}

ScanToScan::Laid ScanToScan::lay(std::size_t i, const Pose& start, const Registrations& registrations) {
  Others others = others_than(i, registrations);
  const auto near =
      stages::near_scans(others.scans, stages::compare_on_scans(queue_, scan(i), others.scans, start, few_));
  auto found = stages::register_to_some(queue_, scan(i), near, others.scans, start, icp_);
  std::string contradiction = contradiction_of(found, start);
  return {{"automatic", std::move(found), std::move(others.ids)}, std::move(contradiction)};
}

std::optional<stages::IslandFit> ScanToScan::place_of_island(const Registrations& island,
                                                             const Registrations& on,
                                                             const std::vector<Pose>& places) {
  std::vector<stages::PlacedScan> moved;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i]) moved.push_back({&scan(i), island[i]->world_from_scan()});
  stages::IslandOptions options;
  options.icp = icp_;
  return stages::tell_island_place(queue_, moved, others_than(products_.size(), on).scans, places, options);
}

void ScanToScan::measure_distances(std::size_t i, const Others& others, ScanRegistration& one) {
  std::vector<stages::PlacedScan> near;
  for (std::size_t k = 0; k < others.scans.size(); ++k)
    if (const auto& with = one.on_scans->icp.others[k]; with.on_m2 > 0 || with.through_m2 > 0)
      near.push_back(others.scans[k]);
  if (near.empty()) return;
  const ScanProduct& product = products_[i];
  one.to_scans =
      stages::distances_to_scans(queue_, product.image, product.segmentation, one.world_from_scan(), near,
                                 kReach * icp_.overlap_m, icp_.normal_deg);
  one.residuals =
      residual_histogram({one.to_scans->image, one.to_scans->segmentation, one.to_scans->signed_m});
}

void ScanToScan::describe(Registrations& registrations) {
  for (std::size_t i = 0; i < registrations.size(); ++i) {
    if (!registrations[i]) continue;
    const Others others = others_than(i, registrations);
    if (others.scans.empty()) continue;
    ScanRegistration& one = *registrations[i];
    const std::string start = one.on_scans ? one.on_scans->start : "";
    one.on_scans =
        OnScans{start, stages::assess_on_scans(queue_, scan(i), others.scans, one.world_from_scan(), icp_),
                others.ids};
    measure_distances(i, others, one);
    if (const auto& open = one.on_scans->icp.icp.degenerate; !open.empty() && !one.fixed && !one.unjudged)
      warn(products_[i],
           fmt::format(
               "the other scans leave its pose undetermined: it is {}; there it is as its start has it: give "
               "a pose that is exact there, another scan that sees more, or a [model]",
               fmt::join(open, ", ")),
           one);
    const double rms_m = one.on_scans->icp.icp.rms_m, noise_m = products_[i].sigma_m;
    if (rms_m > std::max(kFarOff_m, kTimesNoise * noise_m) &&
        largest_overlap(one.on_scans->icp) >= kFirmOverlap)
      warn(products_[i],
           fmt::format(
               "it lies on other scans with an rms of {:.1f} mm, {:.0f} times its noise: the instrument "
               "is not calibrated, something moved, or they are of places that are alike",
               1000 * rms_m, rms_m / std::max(noise_m, kLeastNoise_m)),
           one);
  }
}

}  // namespace hybrid::batch
