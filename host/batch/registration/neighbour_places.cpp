#include "batch/registration/neighbour_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/log.hpp"
#include "geometry/angles.hpp"
#include "stages/registration/pose_evidence.hpp"

namespace hybrid::batch {
namespace {

// ICP to the proxy from a neighbour's pose is believed where it stays this near.
constexpr double kStays_m = 0.1, kStaysDeg = 1;

// A scan that stays where its file has it may see so much of its planar area through the model.
constexpr double kMostThroughKept = 0.2;
// ICP on a model whose faces are off by sigma moves a scan by at most so many.
constexpr double kFaceSigmas = 3;

// Another place must overlap so much as a share of the best: without overlap nothing speaks for it.
constexpr double kLeastRival = 0.5;

// Of the places that alignments give a scan that stays without a pose so many are judged, the surest first.
constexpr std::size_t kMostJudged = 100;

// But for one that is known.
void add_place(const Pose& place, std::vector<Pose>& places) {
  if (std::none_of(places.begin(), places.end(),
                   [&](const Pose& known) { return is_one_place(known, place); }))
    places.push_back(place);
}

}  // namespace

std::size_t count_of(const Registrations& registrations) {
  return static_cast<std::size_t>(std::count_if(registrations.begin(), registrations.end(),
                                                [](const auto& one) { return one.has_value(); }));
}

const ScanModels::Model& ScanModels::of(std::size_t scan) {
  if (!models_[scan])
    models_[scan] =
        std::make_unique<Model>(stages::model_of_scan(products_[scan].image, products_[scan].segmentation));
  return *models_[scan];
}

NeighbourPlaces::NeighbourPlaces(device::Queue& queue, const stages::ProxyModel* model,
                                 const StageOptions& options, const std::vector<ScanProduct>& products,
                                 ScanModels& models, ScanToScan& scan_to_scan, RecordedPoses& recorded)
    : queue_(queue),
      model_(model),
      options_(options),
      products_(products),
      models_(models),
      scan_to_scan_(scan_to_scan),
      recorded_(recorded),
      by_file_(products.size()),
      on_all_(products.size()),
      aligned_(products.size()),
      aligned_back_(products.size()) {}

// What is accepted before what is not; then by what the samples see through, or by the margin.
bool NeighbourPlaces::Neighbour::is_surer_than(const Neighbour& other) const {
  const stages::AutomaticAlignment &a = *alignment, &b = *other.alignment;
  if (a.accepted != b.accepted) return a.accepted;
  if (a.accepted && a.seen_through != b.seen_through) return a.seen_through < b.seen_through;
  return a.margin > b.margin;
}

const stages::AutomaticAlignment& NeighbourPlaces::aligned(const ScanRegistration& scan, std::size_t index,
                                                           std::size_t other) {
  auto& known = aligned_[index];
  if (const auto found = known.find(other); found != known.end()) return found->second;
  stages::AutomaticOptions options = options_.alignment;
  options.of_scan = true;
  auto& found = known[other] =
      stages::align_automatically(queue_, scan.evidence, models_.of(other).model, options);
  scan_to_scan_.judge(index, other, found);
  return found;
}

const stages::AutomaticAlignment& NeighbourPlaces::aligned_back(const ScanRegistration& other, std::size_t by,
                                                                std::size_t index) {
  auto& known = aligned_back_[index];
  if (const auto found = known.find(by); found != known.end()) return found->second;
  return known[by] = stages::inverted(aligned(other, by, index));
}

NeighbourPlaces::Neighbour NeighbourPlaces::best_neighbour(std::size_t scan, bool back,
                                                           const Registrations& registrations,
                                                           const Registrations& abstentions) {
  Neighbour best{scan};
  for (std::size_t other = 0; other < products_.size(); ++other) {
    if (!registrations[other] || models_.of(other).polygons.faces.empty()) continue;
    // What others contradict is not laid on what none of them can judge.
    if (!abstentions[scan]->refusal.empty() && registrations[other]->unjudged) continue;
    const Neighbour found{scan, other, &aligned(*abstentions[scan], scan, other)};
    if (best.alignment == nullptr || found.is_surer_than(best)) best = found;
    if (!back || models_.of(scan).polygons.faces.empty()) continue;
    const Neighbour other_way{scan, other, &aligned_back(*registrations[other], other, scan)};
    if (other_way.alignment->accepted && other_way.is_surer_than(best)) best = other_way;
  }
  return best;
}

void NeighbourPlaces::carry_one(const Neighbour& best, Registrations& registrations,
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

void NeighbourPlaces::place(std::size_t scan, ScanRegistration one, Registrations& registrations,
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
    if (own.icp.degenerate.empty() && own.icp.converged &&
        difference(found, own.world_from_scan()).within(kStays_m, kStaysDeg * kDegree))
      one = std::move(own);
    else
      assess(queue_, *model_, options_, products_[scan], found, one);
  }
  log::info("scan {}: aligned to {}scan {}", products_[scan].id,
            one.how == "neighbour" ? "" : "all others, most of it to ", one.carried_by);
  if (!one.refusal.empty()) one.planar_area.reset();  // of what was refused
  const std::string instead = "aligned to scan " + one.carried_by;
  accept(scan, std::move(one), instead, registrations, abstentions);
}

void NeighbourPlaces::accept(std::size_t scan, ScanRegistration one, const std::string& instead,
                             Registrations& registrations, Registrations& abstentions) {
  one.abstained = false;
  if (!one.refusal.empty() && !one.no_start)
    warn(products_[scan], fmt::format("{}; it is {} instead", one.refusal, instead), one);
  one.refusal.clear();
  registrations[scan] = std::move(one);
  abstentions[scan].reset();
}

void NeighbourPlaces::lay_recorded(Registrations& registrations, Registrations& abstentions) {
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      if (!abstentions[i]) continue;
      const auto start = recorded_.start_of(i, registrations);
      again |= start && lay_recorded(i, *start, registrations, abstentions);
    }
  }
}

bool NeighbourPlaces::lay_recorded(std::size_t scan, const RecordedPoses::Start& start,
                                   Registrations& registrations, Registrations& abstentions) {
  const std::string& by = products_[start.by].id;
  const auto stays = [&](const Pose& found) { return is_one_place(found, start.world_from_scan); };
  const auto judged = [&](const ScanRegistration& one) {
    return stages::judge_pose(queue_, one.evidence, *model_, one.icp, options_.icp, options_.alignment);
  };
  const std::string instead = fmt::format("placed by its file's pose beside scan {}", by);
  ScanRegistration one = *abstentions[scan];
  one.how = "recorded";
  one.start = start.world_from_scan;
  one.recorded = {by, {}};
  one.planar_area.reset();  // of what was refused

  ScanRegistration on_model = one;
  refine_to_model(queue_, *model_, options_, products_[scan], on_model);
  const auto evidence = judged(on_model);
  const auto trusted = [&] { return recorded_.trusted_start_of(scan, registrations); };
  const auto agrees = [&](const Pose& file) {
    return agree(on_model.world_from_scan(), file, kFaceSigmas * on_model.faces->disagreement_m);
  };
  // Along a direction that the model leaves open it is where the file has it; along the others that shows.
  const auto is_held = [&] {
    if (on_model.icp.degenerate.empty()) return true;
    const auto start_there = trusted();
    return start_there && agrees(start_there->world_from_scan);
  };
  const bool fits = evidence.contradiction.empty();
  if (fits && stays(on_model.world_from_scan()) && is_held()) {
    log::info("scan {}: laid on the model from its file's pose beside scan {}", products_[scan].id, by);
    on_model.planar_area = evidence.shares;
    accept(scan, std::move(on_model), instead, registrations, abstentions);
    return true;
  }

  auto laid = scan_to_scan_.lay(scan, start.world_from_scan, registrations);
  if (laid.contradiction.empty() && largest_overlap(laid.on_scans.icp) >= kFirmOverlap &&
      stays(laid.on_scans.icp.icp.world_from_scan)) {
    laid.on_scans.start = "recorded";
    lay(scan, start.world_from_scan, std::move(laid.on_scans), registrations, abstentions);
    return true;
  }

  if (const auto kept = trusted(); kept && (!fits || agrees(kept->world_from_scan))) {
    assess(queue_, *model_, options_, products_[scan], kept->world_from_scan, one);
    if (judged(one).shares.through <= kMostThroughKept &&
        scan_to_scan_.look(scan, kept->world_from_scan, registrations).through <= kMostThroughRecorded) {
      one.start = kept->world_from_scan;
      recorded_.keep(scan, *kept, one);
      accept(scan, std::move(one), instead, registrations, abstentions);
      return true;
    }
  }
  const std::string contradiction =
      fits ? "ICP on the model leads it away, or leaves it open there" : evidence.contradiction;
  abstentions[scan]->neighbour_reason =
      fmt::format("from its file's pose beside scan {}: {}", by, contradiction);
  by_file_[scan] = abstentions[scan]->neighbour_reason + "; ";
  return false;
}

std::string NeighbourPlaces::lay_at_one_of(const std::vector<Pose>& places, double least_rival, bool doubted,
                                           std::size_t scan, Registrations& registrations,
                                           Registrations& abstentions) {
  const auto chosen = scan_to_scan_.choose(scan, places, registrations, least_rival, doubted);
  if (chosen.hypothesis.accepted)
    lay(scan, chosen.hypothesis.start, {"automatic", chosen.hypothesis.found, chosen.others}, registrations,
        abstentions);
  return chosen.hypothesis.reason;
}

void NeighbourPlaces::lay(std::size_t scan, const Pose& start, OnScans on_scans, Registrations& registrations,
                          Registrations& abstentions) {
  ScanRegistration one = std::move(*abstentions[scan]);
  one.how = "scan-icp";
  one.start = start;
  one.on_scans = std::move(on_scans);
  one.carried_by = one.on_scans->nearest();
  one.icp = one.on_scans->icp.icp;
  place(scan, std::move(one), registrations, abstentions);
}

void NeighbourPlaces::lay_all(Registrations& registrations, Registrations& abstentions) {
  const auto lays = [&](std::size_t scan) {
    const auto& automatic = abstentions[scan]->automatic;
    if (!automatic || automatic->hypotheses.empty() || count_of(registrations) < 2) return false;
    const auto places = automatic->hypotheses;  // the scan moves where it is laid
    const std::string why = lay_at_one_of(places, 0, false, scan, registrations, abstentions);
    if (!why.empty()) on_all_[scan] = fmt::format("against all others at once: {}; ", why);
    return why.empty();
  };
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < products_.size(); ++i)
      if (abstentions[i]) again |= lays(i);
  }
}

std::vector<NeighbourPlaces::Neighbour> NeighbourPlaces::known_of(std::size_t scan,
                                                                  const Registrations& registrations) const {
  std::vector<Neighbour> known;
  for (const auto* alignments : {&aligned_[scan], &aligned_back_[scan]})
    for (const auto& [by, alignment] : *alignments)
      if (registrations[by]) known.push_back({scan, by, &alignment});
  return known;
}

std::vector<Pose> NeighbourPlaces::places_of(std::size_t scan, const Registrations& registrations,
                                             bool likely) const {
  std::vector<Pose> places;
  for (const Neighbour& one : known_of(scan, registrations))
    if (!likely || one.alignment->accepted || one.alignment->only_rivals)
      for (const Pose& hypothesis : one.alignment->hypotheses)
        add_place(registrations[one.by]->world_from_scan() * hypothesis, places);
  return places;
}

std::vector<Pose> NeighbourPlaces::places_of_island(const Registrations& island,
                                                    const Registrations& on) const {
  std::vector<Pose> places;
  const auto first =
      std::find_if(island.begin(), island.end(), [](const auto& one) { return one.has_value(); });
  const auto of_first = [&](const Pose& place) { return place * (*first)->world_from_scan(); };
  const auto add = [&](const Pose& place) {
    if (std::none_of(places.begin(), places.end(),
                     [&](const Pose& known) { return is_one_place(of_first(known), of_first(place)); }))
      places.push_back(place);
  };
  const auto add_all = [&](const Registrations& scans, const Registrations& others, bool inverse) {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (!scans[i]) continue;
      for (const auto& [by, alignment] : aligned_[i]) {
        if (!others[by]) continue;
        auto poses = alignment.uncontradicted;
        if (alignment.accepted || alignment.only_rivals)
          poses.insert(poses.end(), alignment.hypotheses.begin(), alignment.hypotheses.end());
        for (const Pose& pose : poses) {
          const Pose place = others[by]->world_from_scan() * pose * scans[i]->world_from_scan().inverse();
          add(inverse ? place.inverse() : place);
        }
      }
    }
  };
  add_all(island, on, false);
  add_all(on, island, true);
  return places;
}

bool NeighbourPlaces::lay_island(const Registrations& island, const Registrations& unplaced,
                                 Registrations& on) {
  const auto found = scan_to_scan_.place_of_island(island, on, places_of_island(island, on));
  if (!found) return false;
  std::vector<std::size_t> scans;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i]) scans.push_back(i);
  Registrations laid_on = on, left = unplaced;
  for (const std::size_t k : found->order) {
    const std::size_t i = scans[k];
    const Pose start = found->world_from_island * island[i]->world_from_scan();
    auto laid = scan_to_scan_.lay(i, start, laid_on);
    if (!laid.contradiction.empty()) return false;
    laid.on_scans.start = "island";
    lay(i, start, std::move(laid.on_scans), laid_on, left);
  }
  on = std::move(laid_on);
  return true;
}

// Where all of its places are contradicted, as by what has moved since, the single scan's word stands.
bool NeighbourPlaces::carry_by_all(const Neighbour& best, Registrations& registrations,
                                   Registrations& abstentions) {
  const Pose carried = registrations[best.by]->world_from_scan() * best.alignment->world_from_scan;
  const bool by_samples = best.alignment->by_samples.has_value();
  const auto places = places_of(best.scan, registrations, by_samples);
  if (places.size() > 1 && count_of(registrations) > 1) {
    const auto chosen = scan_to_scan_.choose(best.scan, places, registrations, kLeastRival);
    const auto& found = chosen.hypothesis;
    const bool here = is_one_place(carried, found.found.icp.world_from_scan);
    if (found.accepted && !here) {
      lay(best.scan, found.start, {"automatic", found.found, chosen.others}, registrations, abstentions);
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
  if (by_samples) return carry_by_samples(best, registrations, abstentions);
  carry_one(best, registrations, abstentions);
  return true;
}

bool NeighbourPlaces::carry_by_samples(const Neighbour& best, Registrations& registrations,
                                       Registrations& abstentions) {
  const Pose start = registrations[best.by]->world_from_scan() * best.alignment->world_from_scan;
  auto laid = scan_to_scan_.lay(best.scan, start, registrations);
  if (!laid.contradiction.empty()) {
    abstentions[best.scan]->neighbour_reason =
        fmt::format("the samples lay it on scan {}, but all others at once contradict that: {}",
                    products_[best.by].id, laid.contradiction);
    abstentions[best.scan]->neighbour.reset();
    return false;
  }
  abstentions[best.scan]->neighbour = *best.alignment;
  lay(best.scan, start, std::move(laid.on_scans), registrations, abstentions);
  return true;
}

// One that was carried may carry others, and what the samples contradict least goes first: of a church two
// aisles lie on each other, turned, with planes that fit better than those of two ends of one do. Then those
// whose alignments leave a choice of places. Alignments that more than rivals speaks against have none: of
// scans of a church's outside each has a dozen places inside. Where that places no more, those that have a
// pose are aligned to the planes of the others: of two scans one may show what tells their place, and it is
// seen by the other, not on its planes. Last come all places of all alignments, for what is no plane to tell.
void NeighbourPlaces::carry_all(Registrations& registrations, Registrations& abstentions) {
  for (bool back = false;;) {
    std::vector<Neighbour> accepted;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      if (!abstentions[i]) continue;
      const Neighbour best = best_neighbour(i, back, registrations, abstentions);
      if (best.alignment == nullptr) continue;
      if (best.alignment->accepted) {
        accepted.push_back(best);
        continue;
      }
      others.push_back(i);
      ScanRegistration& one = *abstentions[i];
      one.neighbour_reason = fmt::format("{}{}against scan {}: {}", by_file_[i], on_all_[i],
                                         products_[best.by].id, best.alignment->reason);
      one.neighbour = *best.alignment;
    }
    std::stable_sort(accepted.begin(), accepted.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.is_surer_than(b); });
    const auto carries = [&](const Neighbour& one) { return carry_by_all(one, registrations, abstentions); };
    const auto lays = [&](std::size_t i, bool doubted) {
      const auto places = places_of(i, registrations, !doubted);
      return !places.empty() && count_of(registrations) > 1 &&
             lay_at_one_of(places, kLeastRival, doubted, i, registrations, abstentions).empty();
    };
    const auto any_is_laid = [&](bool doubted) {
      return std::any_of(others.begin(), others.end(), [&](std::size_t i) { return lays(i, doubted); });
    };
    const bool placed = std::any_of(accepted.begin(), accepted.end(), carries) || any_is_laid(false) ||
                        (back && any_is_laid(true));
    if (!placed && back) return;
    back = !placed;
  }
}

std::vector<PossiblePlace> NeighbourPlaces::possible_places(std::size_t scan,
                                                            const Registrations& registrations) {
  auto surest_first = known_of(scan, registrations);
  std::stable_sort(surest_first.begin(), surest_first.end(),
                   [](const Neighbour& a, const Neighbour& b) { return a.is_surer_than(b); });
  std::vector<Pose> places;
  for (const Neighbour& one : surest_first)
    for (const Pose& hypothesis : one.alignment->hypotheses)
      if (places.size() < kMostJudged)
        add_place(registrations[one.by]->world_from_scan() * hypothesis, places);
  return scan_to_scan_.best_places(scan, places, registrations, kMostPlaces);
}

}  // namespace hybrid::batch
