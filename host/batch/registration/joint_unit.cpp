#include "batch/registration/joint_unit.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/log.hpp"
#include "stages/registration/joint_priors.hpp"
#include "stages/registration/scan_model.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// ICP to the proxy from a neighbour's pose is believed where it stays this near.
constexpr double kStays_m = 0.1, kStaysDeg = 1;

// Alignments to different scans that lie this near are of one place. Another place must overlap so much as a
// share of the best: without overlap nothing speaks for it.
constexpr double kSamePlace_m = 0.3, kSamePlaceDeg = 3, kLeastRival = 0.5;

// Some of what holds a scan along a slide are planes that joint refinement has, too: there these lead.
constexpr double kSlideSigmas = 3;

bool lie_together(const Pose& a, const Pose& b) {
  const auto apart = difference(a, b);
  return apart.distance_m < kSamePlace_m && apart.angle_rad < kSamePlaceDeg * M_PI / 180;
}

// What the model's faces are off, by the scan that shows it best; 0 where they agree.
double face_sigma_m(const Registrations& registrations) {
  double sigma = 0;
  for (const auto& one : registrations)
    if (one && one->solved_with_faces) sigma = std::max(sigma, one->faces->disagreement_m);
  return sigma;
}

// What a scan's own registration knows of its pose. Where the faces are right as they are, ICP's covariance,
// which covers all that lies within centimetres of them, lets neighbours' planes lead a well-placed scan
// away.
std::array<double, 36> prior_of(const ScanRegistration& one, const stages::ModelShapes& model) {
  if (one.faces && one.faces->agree && !one.solved_with_faces && one.world_from_scan().scale == 1)
    if (const auto exact = stages::covariance_on_exact_faces(one.evidence, model, one.world_from_scan()))
      return *exact;
  return one.icp.covariance;
}

Json pair_json(const stages::PairReport& pair, const std::vector<std::string>& ids) {
  return {{"a", ids[pair.a]},
          {"b", ids[pair.b]},
          {"overlap", pair.overlap},
          {"area_m2", pair.area_m2},
          {"planes", pair.planes},
          {"distance_before_m", pair.start_distance_m},
          {"distance_m", pair.distance_m},
          {"median_m", pair.median_m},
          {"strength", pair.strength}};
}

std::size_t count_of(const Registrations& registrations) {
  return static_cast<std::size_t>(std::count_if(registrations.begin(), registrations.end(),
                                                [](const auto& one) { return one.has_value(); }));
}

void make_frame(ScanRegistration& one, const Pose& pose) {
  one.how = "frame";
  one.fixed = true;
  one.abstained = false;
  one.automatic.reset();
  one.neighbour.reset();
  one.neighbour_reason.clear();
  one.start = one.icp.world_from_scan = pose;
}

void make_unplaced(ScanRegistration& one) {
  one.how = "neighbour";
  one.fixed = false;
  one.abstained = true;
  one.automatic = stages::AutomaticAlignment{};
  one.neighbour.reset();
  one.carried_by.clear();
  one.start = one.icp.world_from_scan = Pose();
}

}  // namespace

NeighbourRegistration::NeighbourRegistration(device::Queue& queue, const stages::ProxyModel* model,
                                             const StageOptions& options,
                                             const std::vector<ScanProduct>& products)
    : queue_(queue),
      model_(model),
      options_(options),
      products_(products),
      seen_(products.size()),
      scan_to_scan_(queue, options, products),
      starts_(products.size()),
      on_all_(products.size()),
      aligned_(products.size()) {}

// What is accepted before what is not; then by what the samples see through, or by the margin.
bool NeighbourRegistration::Neighbour::is_surer_than(const Neighbour& other) const {
  const stages::AutomaticAlignment &a = *alignment, &b = *other.alignment;
  if (a.accepted != b.accepted) return a.accepted;
  if (a.accepted && a.seen_through != b.seen_through) return a.seen_through < b.seen_through;
  return a.margin > b.margin;
}

const NeighbourRegistration::Seen& NeighbourRegistration::seen(std::size_t scan) {
  if (!seen_[scan])
    seen_[scan] =
        std::make_unique<Seen>(stages::model_of_scan(products_[scan].image, products_[scan].segmentation));
  return *seen_[scan];
}

void NeighbourRegistration::begin_without_model(const std::vector<io::SceneScan>& entries, const Vec3& shift,
                                                Registrations& registrations, Registrations& abstentions) {
  for (const ScanProduct& product : products_) {
    recorded_.push_back(product.recorded_pose);
    if (recorded_.back()) recorded_.back()->translation -= shift;
  }
  std::optional<Pose> world_from_frame;  // of the first scan whose file has a pose, and the pose there
  Pose frame_recorded;
  for (std::size_t i = 0; i < products_.size(); ++i) {
    ScanRegistration one;
    one.evidence = stages::gather_evidence(products_[i].image, products_[i].segmentation,
                                           options_.alignment.rays, options_.alignment.seed);
    const bool given = entries[i].pose.has_value();
    if (given)
      one.start = pose_from_row_major(*entries[i].pose);
    else if (i == 0)
      one.start = recorded_[i].value_or(Pose());
    one.how = given && (entries[i].fixed || i == 0) ? "given" : i == 0 ? "frame" : "neighbour";
    one.fixed = entries[i].fixed || i == 0;
    one.icp.world_from_scan = one.start;
    one.icp.converged = true;
    one.abstained = !one.fixed;
    if (one.fixed && !world_from_frame && recorded_[i]) {
      world_from_frame = one.start;
      frame_recorded = *recorded_[i];
    }
    if (one.abstained && given)
      starts_[i] = ScanStart{one.start, "given"};
    else if (one.abstained && world_from_frame)
      starts_[i] = recorded_start(recorded_[i], frame_recorded, *world_from_frame);
    if (starts_[i] && !given && entries[i].scanner) starts_[i]->from = kOneFrame;
    if (!entries[i].landmarks.empty()) {
      one.warnings.push_back(fmt::format(
          "its {} landmarks (line {} on) place nothing: they are corners of a model, and the scene has no "
          "[model]; name one, or give a pose",
          entries[i].landmarks.size(), entries[i].landmarks[0].line));
      log::warning("scan {}: {}", products_[i].id, one.warnings.back());
    }
    if (one.abstained) one.automatic = stages::AutomaticAlignment{};
    auto& list = one.abstained ? abstentions : registrations;
    list[i] = std::move(one);
  }
  frame_is_free_ =
      std::none_of(entries.begin(), entries.end(),
                   [](const io::SceneScan& entry) { return entry.pose.has_value(); }) &&
      std::none_of(starts_.begin(), starts_.end(), [](const auto& start) { return start.has_value(); });
}

const stages::AutomaticAlignment& NeighbourRegistration::aligned(const ScanRegistration& scan,
                                                                 std::size_t index, std::size_t other) {
  auto& known = aligned_[index];
  if (const auto found = known.find(other); found != known.end()) return found->second;
  stages::AutomaticOptions options = options_.alignment;
  options.of_scan = true;
  auto& found = known[other] = stages::align_automatically(queue_, scan.evidence, seen(other).model, options);
  scan_to_scan_.judge(index, other, found);
  return found;
}

NeighbourRegistration::Neighbour NeighbourRegistration::best_neighbour(std::size_t scan,
                                                                       const Registrations& registrations,
                                                                       const Registrations& abstentions) {
  Neighbour best{scan};
  for (std::size_t other = 0; other < products_.size(); ++other) {
    if (!registrations[other] || seen(other).polygons.faces.empty()) continue;
    // What others contradict is not laid on what none of them can judge.
    if (!abstentions[scan]->refusal.empty() && registrations[other]->unjudged) continue;
    const Neighbour found{scan, other, &aligned(*abstentions[scan], scan, other)};
    if (best.alignment == nullptr || found.is_surer_than(best)) best = found;
  }
  return best;
}

void NeighbourRegistration::carry_one(const Neighbour& best, Registrations& registrations,
                                      Registrations& abstentions) {
  ScanRegistration one = std::move(*abstentions[best.scan]);
  one.how = "neighbour";
  one.on_scans.reset();
  one.carried_by = products_[best.by].id;
  one.start = registrations[best.by]->world_from_scan() * best.alignment->world_from_scan;
  one.neighbour = *best.alignment;
  one.icp.world_from_scan = one.start;
  one.icp.converged = true;
  place(best.scan, std::move(one), registrations, abstentions);
}

void NeighbourRegistration::place(std::size_t scan, ScanRegistration one, Registrations& registrations,
                                  Registrations& abstentions) {
  one.abstained = false;
  one.held_by_model = false;
  if (model_ != nullptr) {
    // What it sees of the proxy may hold it as well; where it does not, ICP leads away.
    const Pose found = one.world_from_scan();
    ScanRegistration own = one;
    own.start = found;
    refine_to_model(queue_, *model_, options_, products_[scan], own);
    own.start = one.start;
    const auto moved = difference(found, own.world_from_scan());
    if (own.icp.degenerate.empty() && own.icp.converged && moved.distance_m < kStays_m &&
        moved.angle_rad < kStaysDeg * M_PI / 180)
      one = std::move(own);
    else
      assess(queue_, *model_, options_, products_[scan], found, one);
  }
  log::info("scan {}: aligned to {}scan {}", products_[scan].id,
            one.how == "neighbour" ? "" : "all others, most of it to ", one.carried_by);
  if (!one.refusal.empty()) {
    one.warnings.push_back(fmt::format("{}; it is aligned to scan {} instead", one.refusal, one.carried_by));
    log::warning("scan {}: {}", products_[scan].id, one.warnings.back());
    one.refusal.clear();
    one.planar_area.reset();
  }
  registrations[scan] = std::move(one);
  abstentions[scan].reset();
}

bool NeighbourRegistration::lay_one(std::size_t scan, Registrations& registrations,
                                    Registrations& abstentions) {
  const ScanRegistration& abstained = *abstentions[scan];
  if (!abstained.automatic || abstained.automatic->hypotheses.empty()) return false;
  const auto chosen = scan_to_scan_.choose(scan, abstained.automatic->hypotheses, registrations);
  if (!chosen.hypothesis.accepted) {
    on_all_[scan] = fmt::format("against all others at once: {}; ", chosen.hypothesis.reason);
    return false;
  }
  lay(scan, chosen, registrations, abstentions);
  return true;
}

void NeighbourRegistration::lay(std::size_t scan, const ScanToScan::Chosen& chosen,
                                Registrations& registrations, Registrations& abstentions) {
  ScanRegistration one = std::move(*abstentions[scan]);
  one.how = "scan-icp";
  one.start = chosen.hypothesis.start;
  one.on_scans = OnScans{"automatic", chosen.hypothesis.found, chosen.others};
  one.carried_by = one.on_scans->nearest();
  one.icp = chosen.hypothesis.found.icp;
  place(scan, std::move(one), registrations, abstentions);
}

void NeighbourRegistration::lay_all(Registrations& registrations, Registrations& abstentions) {
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < products_.size(); ++i)
      if (abstentions[i] && count_of(registrations) > 1) again |= lay_one(i, registrations, abstentions);
  }
}

void NeighbourRegistration::carry(Registrations& registrations, Registrations& abstentions) {
  if (model_ == nullptr) scan_to_scan_.place(starts_, registrations, abstentions);
  if (model_ != nullptr && options_.automatic == "never") return;  // a pose by planes alone is not wanted
  if (model_ != nullptr) lay_all(registrations, abstentions);
  carry_all(registrations, abstentions);
  if (frame_is_free_) keep_largest_island(registrations, abstentions);
}

std::vector<Pose> NeighbourRegistration::places_of(std::size_t scan, const Registrations& registrations,
                                                   bool only_rivals) const {
  std::vector<Pose> places;
  for (const auto& [by, alignment] : aligned_[scan]) {
    if (!registrations[by] || (only_rivals && !alignment.only_rivals)) continue;
    for (const Pose& hypothesis : alignment.hypotheses) {
      const Pose place = registrations[by]->world_from_scan() * hypothesis;
      if (std::none_of(places.begin(), places.end(),
                       [&](const Pose& known) { return lie_together(known, place); }))
        places.push_back(place);
    }
  }
  return places;
}

// Where all of its places are contradicted, as by what has moved since, the single scan's word stands.
bool NeighbourRegistration::carry_by_all(const Neighbour& best, Registrations& registrations,
                                         Registrations& abstentions) {
  const Pose carried = registrations[best.by]->world_from_scan() * best.alignment->world_from_scan;
  const auto places = places_of(best.scan, registrations, false);
  if (places.size() > 1 && count_of(registrations) > 1) {
    const auto chosen = scan_to_scan_.choose(best.scan, places, registrations, kLeastRival);
    const auto& found = chosen.hypothesis;
    const bool here = lie_together(carried, found.found.icp.world_from_scan);
    if (found.accepted && !here) {
      lay(best.scan, chosen, registrations, abstentions);
      return true;
    }
    if (found.found_any && (found.has_rival || !here)) {
      abstentions[best.scan]->neighbour_reason = fmt::format(
          "against all others at once: {}",
          found.has_rival ? found.reason
                          : "they contradict the place that planes found, and of the best, " + found.reason);
      abstentions[best.scan]->neighbour.reset();
      return false;
    }
  }
  carry_one(best, registrations, abstentions);
  return true;
}

// Alignments that more than rivals speaks against count for nothing here: of scans of a church's outside each
// has a dozen places inside.
bool NeighbourRegistration::lay_by_neighbours(std::size_t scan, Registrations& registrations,
                                              Registrations& abstentions) {
  if (count_of(registrations) < 2) return false;
  const auto places = places_of(scan, registrations, true);
  if (places.empty()) return false;
  const auto chosen = scan_to_scan_.choose(scan, places, registrations, kLeastRival);
  if (!chosen.hypothesis.accepted) return false;
  lay(scan, chosen, registrations, abstentions);
  return true;
}

// One that was carried may carry others, and what the samples contradict least goes first: of a church two
// aisles lie on each other, turned, with planes that fit better than those of two ends of one do.
void NeighbourRegistration::carry_all(Registrations& registrations, Registrations& abstentions) {
  for (;;) {
    std::vector<Neighbour> accepted;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      if (!abstentions[i]) continue;
      const Neighbour best = best_neighbour(i, registrations, abstentions);
      if (best.alignment == nullptr) continue;
      if (best.alignment->accepted) {
        accepted.push_back(best);
        continue;
      }
      others.push_back(i);
      ScanRegistration& one = *abstentions[i];
      one.neighbour_reason =
          fmt::format("{}against scan {}: {}", on_all_[i], products_[best.by].id, best.alignment->reason);
      one.neighbour = *best.alignment;
    }
    std::stable_sort(accepted.begin(), accepted.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.is_surer_than(b); });
    const auto carries = [&](const Neighbour& one) { return carry_by_all(one, registrations, abstentions); };
    const auto lays = [&](std::size_t i) { return lay_by_neighbours(i, registrations, abstentions); };
    if (std::none_of(accepted.begin(), accepted.end(), carries) &&
        std::none_of(others.begin(), others.end(), lays))
      return;
  }
}

void NeighbourRegistration::keep_largest_island(Registrations& registrations, Registrations& abstentions) {
  std::vector<Registrations> islands;
  std::size_t largest = 0;
  for (;;) {
    islands.push_back(std::exchange(registrations, Registrations(products_.size())));
    if (count_of(islands.back()) > count_of(islands[largest])) largest = islands.size() - 1;
    if (count_of(abstentions) < 2) break;  // no more can hang together
    const auto first =
        std::find_if(abstentions.begin(), abstentions.end(), [](const auto& one) { return one.has_value(); });
    const auto frame = static_cast<std::size_t>(first - abstentions.begin());
    make_frame(**first, recorded_[frame].value_or(Pose()));
    registrations[frame] = std::exchange(*first, std::nullopt);
    carry_all(registrations, abstentions);
  }
  registrations = std::exchange(islands[largest], {});
  for (const Registrations& island : islands)
    for (std::size_t i = 0; i < island.size(); ++i)
      if (island[i]) {
        abstentions[i] = island[i];
        make_unplaced(*abstentions[i]);
      }
  carry_all(registrations, abstentions);  // of the others some may lie on what they did not carry
  for (Registrations& island : islands) {
    for (std::size_t i = 0; i < island.size(); ++i)
      if (!abstentions[i]) island[i].reset();
    if (count_of(island) > 1) islands_.push_back(std::move(island));
  }
}

// The scans of an island, refined together, are told of each other, and how they lie.
void NeighbourRegistration::tell_island(Registrations& island, Registrations& abstentions) {
  std::vector<std::size_t> scans;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i]) scans.push_back(i);
  const std::size_t frame = scans.front();
  island[frame]->fixed = true;
  if (options_.joint) figures_["islands"].push_back(refine_all(island));
  scan_to_scan_.describe(island);
  const Pose frame_from_world = island[frame]->world_from_scan().inverse();
  for (const std::size_t i : scans) {
    ScanRegistration &one = *abstentions[i], &placed = *island[i];
    one.warnings = std::move(placed.warnings);
    one.to_scans = std::move(placed.to_scans);
    one.residuals = std::move(placed.residuals);
    one.island = Island{
        products_[frame].id, frame_from_world * placed.world_from_scan(), {}, std::move(placed.on_scans)};
    for (const std::size_t k : scans)
      if (k != i) one.island->others.push_back(products_[k].id);
    one.neighbour_reason = fmt::format(
        "it hangs together with {}, but these with no more of the others: process them on their own{}{}",
        fmt::join(one.island->others, ", "), one.neighbour_reason.empty() ? "" : "; ", one.neighbour_reason);
  }
}

void NeighbourRegistration::hold_slides(Registrations& registrations) {
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      if (!registrations[i] || !registrations[i]->slides()) continue;
      ScanRegistration& one = *registrations[i];
      one.slide = scan_to_scan_.hold_slide(i, registrations);
      if (one.slides()) continue;
      const stages::SlideOnScans& found = one.slide->found;
      Pose pose = one.world_from_scan();
      pose.translation += found.shift_m * found.direction;
      assess(queue_, *model_, options_, products_[i], pose, one);
      log::info("scan {}: {}; other scans hold it there, {:.1f} mm from its start", products_[i].id,
                fmt::join(one.icp.degenerate, ", "), 1000 * found.shift_m);
      again = true;
    }
  }
}

void NeighbourRegistration::refine(Registrations& registrations, Registrations& abstentions) {
  if (options_.joint && model_ != nullptr) hold_slides(registrations);
  if (options_.joint && count_of(registrations) > 1) figures_ = refine_all(registrations);
  if (model_ == nullptr) scan_to_scan_.describe(registrations);
  for (Registrations& island : islands_) tell_island(island, abstentions);
}

Json NeighbourRegistration::refine_all(Registrations& registrations) {
  std::vector<std::size_t> index;
  std::vector<stages::JointScan> scans;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < products_.size(); ++i) {
    if (!registrations[i]) continue;
    const ScanRegistration& one = *registrations[i];
    stages::JointScan scan{
        &one.evidence, &seen(i).shapes(), one.world_from_scan(), one.fixed, {}, face_sigma_m(registrations)};
    if (model_ != nullptr && one.held_by_model && !one.fixed)
      scan.covariance = prior_of(one, model_->shapes());
    if (one.slide && one.slide->found.accepted)
      scan.covariance =
          stages::covariance_held_along(*scan.covariance, one.world_from_scan().translation,
                                        one.slide->found.direction, kSlideSigmas * one.slide->found.sigma_m);
    // What samples outside planes know of a pose, planes alone do not: through a door few planes hold a scan.
    if (one.how == "scan-icp") scan.covariance = one.on_scans->icp.icp.covariance;
    scans.push_back(scan);
    index.push_back(i);
    ids.push_back(products_[i].id);
  }
  const auto joint = stages::refine_jointly(scans, options_.joint_poses);
  Json moved = Json::array(), pairs = Json::array();
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const auto step = difference(scans[k].start, joint.world_from_scan[k]);
    moved.push_back({{"scan", ids[k]}, {"mm", 1000 * step.distance_m}, {"deg", step.angle_rad * 180 / M_PI}});
    ScanRegistration& one = *registrations[index[k]];
    if (one.fixed || (step.distance_m == 0 && step.angle_rad == 0)) continue;
    if (model_ != nullptr)
      assess(queue_, *model_, options_, products_[index[k]], joint.world_from_scan[k], one);
    else
      one.icp.world_from_scan = joint.world_from_scan[k];
    one.icp.covariance = joint.covariance[k];
    if (one.faces) stages::add_pose_sigma(one.icp.covariance, *one.faces);
  }
  for (const auto& pair : joint.pairs) pairs.push_back(pair_json(pair, ids));
  return {{"scans", ids},
          {"frame", model_ ? "model" : ids.front()},
          {"iterations", joint.iterations},
          {"converged", joint.converged},
          {"plane_sigma_m", joint.sigma_m},
          {"moved", moved},
          {"pairs", pairs}};
}

}  // namespace hybrid::batch
