#include "batch/registration/joint_unit.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "batch/registration/shared_scale.hpp"
#include "core/log.hpp"
#include "stages/registration/joint_priors.hpp"
#include "stages/registration/scan_model.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

// Some of what holds a scan along a slide are planes that joint refinement has, too: there these lead.
constexpr double kSlideSigmas = 3;

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

// Of some that have a pose the one in whose frame they are: where it was taken from them, the first.
std::size_t frame_of(const Registrations& registrations) {
  const auto fixed = std::find_if(registrations.begin(), registrations.end(),
                                  [](const auto& one) { return one && one->fixed; });
  const auto first = std::find_if(registrations.begin(), registrations.end(),
                                  [](const auto& one) { return one.has_value(); });
  return static_cast<std::size_t>((fixed == registrations.end() ? first : fixed) - registrations.begin());
}

std::vector<PossiblePlace> places_on_model(const stages::AutomaticAlignment& found) {
  std::vector<PossiblePlace> places = {
      {found.world_from_scan,
       fmt::format("{:.0f} % of its planar area lie on faces, {:.1f} % are seen through them",
                   100 * found.shares.supported, 100 * found.shares.through)}};
  for (const stages::RivalPose& rival : found.rivals) {
    if (rival.strength >= 1 || places.size() == kMostPlaces) break;
    places.push_back(
        {rival.world_from_scan,
         fmt::format("{}; {:.2f} % of the planar area speak for the first place, {:.2f} % for this one",
                     rival.words, 100 * rival.comparison.for_it, 100 * rival.comparison.against_it)});
  }
  return places;
}

void make_frame(ScanRegistration& one, const Pose& pose) {
  one.how = "frame";
  one.fixed = true;
  one.abstained = false;
  one.neighbour.reset();
  one.neighbour_reason.clear();
  one.start = one.icp.world_from_scan = pose;
}

void make_unplaced(ScanRegistration& one) {
  one.how = "neighbour";
  one.fixed = false;
  one.abstained = true;
  one.neighbour.reset();
  one.on_scans.reset();
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
      models_(products),
      scan_to_scan_(queue, options, products),
      recorded_(products, scan_to_scan_),
      starts_(products, scan_to_scan_, recorded_),
      places_(queue, model, options, products, models_, scan_to_scan_, recorded_) {}

void NeighbourRegistration::begin_without_model(const std::vector<io::SceneScan>& entries, const Vec3& shift,
                                                Registrations& registrations, Registrations& abstentions) {
  shift_ = shift;
  std::optional<std::size_t> frame;  // the first scan that stays whose file has a pose
  for (std::size_t i = 0; i < products_.size(); ++i) {
    ScanRegistration one;
    one.evidence = stages::gather_evidence(products_[i].image, products_[i].segmentation,
                                           options_.alignment.rays, options_.alignment.seed);
    const bool given = entries[i].pose.has_value();
    if (given)
      one.start = pose_from_row_major(*entries[i].pose);
    else if (i == 0)
      one.start = recorded_or_none(i);
    one.how = given && (entries[i].fixed || i == 0) ? "given" : i == 0 ? "frame" : "neighbour";
    one.fixed = entries[i].fixed || i == 0;
    one.icp.world_from_scan = one.start;
    one.icp.converged = true;
    one.abstained = !one.fixed;
    if (one.fixed && !frame && products_[i].recorded_pose) frame = i;
    if (one.abstained && given)
      starts_.give(i, one.start);
    else if (one.abstained && frame)
      starts_.give_recorded(i, *frame, registrations[*frame]->start, entries[i].scanner.has_value());
    if (!entries[i].landmarks.empty())
      warn(products_[i],
           fmt::format("its {} landmarks (line {} on) place nothing: they are corners of a model, and the "
                       "scene has no [model]; name one, or give a pose",
                       entries[i].landmarks.size(), entries[i].landmarks[0].line),
           one);
    auto& list = one.abstained ? abstentions : registrations;
    list[i] = std::move(one);
  }
  frame_is_free_ = std::none_of(entries.begin(), entries.end(),
                                [](const io::SceneScan& entry) { return entry.pose.has_value(); }) &&
                   !starts_.any();
}

Pose NeighbourRegistration::recorded_or_none(std::size_t scan) const {
  Pose pose = products_[scan].recorded_pose.value_or(Pose());
  if (products_[scan].recorded_pose) pose.translation -= shift_;
  return pose;
}

void NeighbourRegistration::carry(Registrations& registrations, Registrations& abstentions) {
  if (options_.icp.free_scale && model_ != nullptr)
    share_scale(queue_, *model_, options_, products_, registrations);
  if (options_.joint && model_ != nullptr) hold_slides(registrations);  // others may be laid on them
  if (model_ == nullptr) place_from_starts(registrations, abstentions);
  if (model_ != nullptr) places_.lay_recorded(registrations, abstentions);
  if (model_ != nullptr && options_.automatic == "never") return;  // a pose by planes alone is not wanted
  if (model_ != nullptr) places_.lay_all(registrations, abstentions);
  places_.carry_all(registrations, abstentions);
  if (frame_is_free_) keep_largest_island(registrations, abstentions);
}

// A pose that little but scans without one would hold waits for these, but where files are trusted: what the
// frame alone sees of it, through a door or along a wall, may contradict it, or say nothing.
void NeighbourRegistration::place_from_starts(Registrations& registrations, Registrations& abstentions) {
  starts_.place_recorded(registrations, abstentions);
  starts_.place_firmly(registrations, abstentions);
  Registrations waiting(products_.size());
  for (std::size_t i = 0; i < products_.size(); ++i)
    if (starts_.waits(i)) waiting[i] = std::exchange(abstentions[i], std::nullopt);
  if (count_of(waiting) > 0 && count_of(abstentions) > 0) places_.carry_all(registrations, abstentions);
  for (std::size_t i = 0; i < products_.size(); ++i)
    if (waiting[i]) abstentions[i] = std::move(waiting[i]);
  starts_.place(registrations, abstentions);
}

// Of two the smaller one is laid on the larger one, and what that gives may tell the next one's place. What
// single scans tell of each other is known.
void NeighbourRegistration::join_islands(std::vector<Registrations>& islands) {
  Registrations unplaced(products_.size());
  for (const Registrations& island : islands)
    for (std::size_t i = 0; i < island.size(); ++i)
      if (island[i]) {
        unplaced[i] = island[i];
        make_unplaced(*unplaced[i]);
      }
  const auto joins = [&] {
    std::stable_sort(islands.begin(), islands.end(), [](const Registrations& a, const Registrations& b) {
      return count_of(a) > count_of(b);
    });
    for (auto on = islands.begin(); on != islands.end() && count_of(*on) > 1; ++on)
      for (auto island = on + 1; island != islands.end(); ++island)
        if (places_.lay_island(*island, unplaced, *on)) {
          islands.erase(island);
          return true;
        }
    return false;
  };
  while (joins()) {
  }
}

void NeighbourRegistration::keep_largest_island(Registrations& registrations, Registrations& abstentions) {
  std::vector<Registrations> islands;
  for (;;) {
    islands.push_back(std::exchange(registrations, Registrations(products_.size())));
    if (count_of(abstentions) < 2) break;  // no more can hang together
    const auto first =
        std::find_if(abstentions.begin(), abstentions.end(), [](const auto& one) { return one.has_value(); });
    const auto frame = static_cast<std::size_t>(first - abstentions.begin());
    make_frame(**first, recorded_or_none(frame));
    registrations[frame] = std::exchange(*first, std::nullopt);
    places_.carry_all(registrations, abstentions);
  }
  join_islands(islands);
  const auto largest = std::max_element(
      islands.begin(), islands.end(),
      [](const Registrations& a, const Registrations& b) { return count_of(a) < count_of(b); });
  registrations = std::exchange(*largest, {});
  for (const Registrations& island : islands)
    for (std::size_t i = 0; i < island.size(); ++i)
      if (island[i]) {
        abstentions[i] = island[i];
        make_unplaced(*abstentions[i]);
      }
  places_.carry_all(registrations, abstentions);  // of the others some may lie on what they did not carry
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
  const std::size_t frame = frame_of(island);
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
  for (std::size_t i = 0; model_ != nullptr && i < products_.size(); ++i)
    if (registrations[i])
      if (const auto words = recorded_.contradiction_of(i, registrations); !words.empty())
        warn(products_[i], words, *registrations[i]);
  for (Registrations& island : islands_) tell_island(island, abstentions);
  for (std::size_t i = 0; i < products_.size(); ++i)
    if (abstentions[i]) abstentions[i]->places = places_of(i, *abstentions[i], registrations);
}

std::vector<PossiblePlace> NeighbourRegistration::places_of(std::size_t i, const ScanRegistration& abstained,
                                                            const Registrations& registrations) {
  const bool on_model = abstained.automatic && abstained.automatic->has_pose;
  if (on_model && abstained.automatic->only_rivals) return places_on_model(*abstained.automatic);
  auto places = places_.possible_places(i, registrations);
  if (places.empty() && on_model) places = places_on_model(*abstained.automatic);
  return places;
}

Json NeighbourRegistration::refine_all(Registrations& registrations) {
  std::vector<std::size_t> index;
  std::vector<stages::JointScan> scans;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < products_.size(); ++i) {
    if (!registrations[i]) continue;
    const ScanRegistration& one = *registrations[i];
    stages::JointScan scan{&one.evidence,
                           &models_.of(i).shapes(),
                           one.world_from_scan(),
                           one.fixed,
                           {},
                           face_sigma_m(registrations)};
    if (model_ != nullptr && one.held_by_model && !one.fixed)
      scan.covariance = prior_of(one, model_->shapes());
    if (one.slide && one.slide->found.accepted)
      scan.covariance =
          stages::covariance_held_along(*scan.covariance, one.world_from_scan().translation,
                                        one.slide->found.direction, kSlideSigmas * one.slide->found.sigma_m);
    // What samples outside planes know of a pose, planes alone do not: through a door few planes hold a scan.
    if (one.how == "scan-icp") scan.covariance = one.on_scans->icp.icp.covariance;
    if (one.recorded && one.recorded->word) scan.covariance = one.icp.covariance;
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
          {"frame", model_ ? "model" : products_[frame_of(registrations)].id},
          {"iterations", joint.iterations},
          {"converged", joint.converged},
          {"plane_sigma_m", joint.sigma_m},
          {"moved", moved},
          {"pairs", pairs}};
}

}  // namespace hybrid::batch
