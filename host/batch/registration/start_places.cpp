#include "batch/registration/start_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/log.hpp"

namespace hybrid::batch {
namespace {

// Of the scan's area, or the other's, on each other's surfaces: what is held firmly is placed first.
constexpr std::array<double, 4> kOverlaps = {0.5, kFirmOverlap, 0.05, 0.01};
constexpr const char *kGiven = "given", *kRecorded = "recorded", *kOneFrame = "coordinates";

std::string refused_in_words(const OnScans& on, const std::string& from, const std::string& contradiction) {
  return fmt::format(
      "the other scans contradict the pose that ICP found from the {} pose: {}; its rms is {:.4g} m, {:.0f} "
      "% of the scan's area lie on surfaces of others, and of all that can be compared {:.0f} % are seen "
      "through. Check the pose (world_from_scan, row by row, metres){}; fixed = true keeps a given pose as "
      "it is",
      from, contradiction, on.icp.icp.rms_m, 100 * on.icp.icp.overlap, 100 * on.icp.seen_through,
      from == kRecorded ? " in the scan's file, or give one in the scene file" : "");
}

std::vector<std::string> ids_of(const Registrations& registrations,
                                const std::vector<ScanProduct>& products) {
  std::vector<std::string> ids;
  for (std::size_t k = 0; k < registrations.size(); ++k)
    if (registrations[k]) ids.push_back(products[k].id);
  return ids;
}

}  // namespace

StartPlaces::StartPlaces(const std::vector<ScanProduct>& products, ScanToScan& scan_to_scan,
                         RecordedPoses& recorded)
    : products_(products), scan_to_scan_(scan_to_scan), recorded_(recorded), starts_(products.size()) {}

void StartPlaces::give(std::size_t i, const Pose& world_from_scan) {
  starts_[i] = Start{world_from_scan, kGiven};
  any_ = true;
}

void StartPlaces::give_recorded(std::size_t i, std::size_t frame, const Pose& world_from_frame, bool guess) {
  const auto pose = recorded_.pose_by(i, frame, world_from_frame);
  if (!pose) return;
  starts_[i] = Start{*pose, guess ? kOneFrame : kRecorded, frame};
  any_ = true;
}

bool StartPlaces::place_one(std::size_t i, double least_overlap, Registrations& registrations,
                            Registrations& abstentions) {
  const auto others = ids_of(registrations, products_);
  if (others.empty()) return false;
  Start& start = *starts_[i];
  if (!start.found || start.found->others != others) {  // poses stay once they are found
    auto laid = scan_to_scan_.lay_from(i, start.world_from_scan, registrations);
    start.found = std::move(laid.on_scans);
    start.found->start = start.from;
    start.contradiction = std::move(laid.contradiction);
  }
  if (!start.contradiction.empty() || largest_overlap(start.found->icp) < least_overlap) return false;
  // Where the others let it slide it would stay at what they contradict.
  if (is_trusted(start) && !start.found->icp.icp.degenerate.empty()) return false;
  accept(i, registrations, abstentions);
  return true;
}

void StartPlaces::accept(std::size_t i, Registrations& registrations, Registrations& abstentions) {
  Start& start = *starts_[i];
  const double overlap = largest_overlap(start.found->icp);
  ScanRegistration one = std::move(*abstentions[i]);
  abstentions[i].reset();
  one.how = "scan-icp";
  one.abstained = false;
  one.held_by_model = false;
  one.start = start.world_from_scan;
  one.on_scans.emplace(*std::move(start.found));
  one.carried_by = one.on_scans->nearest();
  one.icp = one.on_scans->icp.icp;
  if (overlap < kFirmOverlap)
    warn(products_[i],
         fmt::format(
             "little holds it: at most {:.0f} % of it, or of a scan that had a pose, lie on each other, "
             "so that it may be off by more than its covariance says; another scan between them, or a "
             "model, would hold it",
             100 * overlap),
         one);
  if (!one.icp.converged)
    warn(products_[i],
         fmt::format("ICP on the other scans did not converge in {} iterations: give a pose that is nearer",
                     one.icp.iterations),
         one);
  log::info("scan {}: laid on scan {} from its {} pose", products_[i].id, one.carried_by, start.from);
  registrations[i] = std::move(one);
  starts_[i].reset();
}

// What the others contradict is refused, a guess dropped; what they do not tell of stays.
void StartPlaces::settle(std::size_t i, Registrations& registrations, Registrations& abstentions) {
  const Start& start = *starts_[i];
  if (start.from == kOneFrame) return;
  ScanRegistration& one = *abstentions[i];
  one.how = start.from;
  if (start.found && !start.contradiction.empty() && largest_overlap(start.found->icp) >= kOverlaps.back()) {
    one.on_scans = start.found;
    one.refusal = refused_in_words(*one.on_scans, start.from, start.contradiction);
    return;
  }
  auto seen = scan_to_scan_.look(i, start.world_from_scan, registrations);
  if (seen.through > kMostThroughRecorded) {
    seen.on_scans.start = start.from;
    one.refusal = fmt::format(
        "the other scans contradict the {} pose: {:.0f} % of the scan's area are seen through there, and "
        "less "
        "than {:.0f} % lie on surfaces of others. Check it (world_from_scan, row by row, metres); fixed = "
        "true keeps a given pose as it is",
        start.from, 100 * seen.through, 100 * kOverlaps.back());
    one.on_scans = std::move(seen.on_scans);
    return;
  }
  one.abstained = false;
  one.unjudged = true;
  one.start = one.icp.world_from_scan = start.world_from_scan;
  one.icp.converged = true;
  warn(products_[i],
       fmt::format("its {} pose is as it was: less than {:.0f} % of the scan lie on surfaces of others",
                   start.from, 100 * kOverlaps.back()),
       one);
  registrations[i] = std::move(one);
  abstentions[i].reset();
}

void StartPlaces::place_firmly(Registrations& registrations, Registrations& abstentions) {
  place_down_to(kFirmOverlap, registrations, abstentions);
}

void StartPlaces::place_recorded(Registrations& registrations, Registrations& abstentions) {
  const auto pass = [&](bool keep) {
    bool placed = false;
    for (std::size_t i = 0; i < starts_.size(); ++i)
      placed |= starts_[i] && is_trusted(*starts_[i]) && place_near(i, keep, registrations, abstentions);
    return placed;
  };
  for (const bool keep : {false, true, false})
    while (pass(keep)) {
    }
}

// What the others contradict as it is, or lead away, is left.
bool StartPlaces::place_near(std::size_t i, bool keep, Registrations& registrations,
                             Registrations& abstentions) {
  Start& start = *starts_[i];
  const auto seen = scan_to_scan_.look(i, start.world_from_scan, registrations);
  if (seen.through > kMostThroughRecorded) return false;
  if (largest_overlap(seen.on_scans.icp) >= kFirmOverlap) {
    auto laid = scan_to_scan_.lay(i, start.world_from_scan, registrations);
    if (!laid.contradiction.empty() ||
        !is_one_place(start.world_from_scan, laid.on_scans.icp.icp.world_from_scan))
      return false;
    start.found = std::move(laid.on_scans);
    start.found->start = start.from;
    accept(i, registrations, abstentions);
    return true;
  }
  if (!keep) return false;
  ScanRegistration one = std::move(*abstentions[i]);
  abstentions[i].reset();
  one.how = start.from;
  one.abstained = false;
  one.start = start.world_from_scan;
  recorded_.keep(i, {one.start, start.frame}, one);
  registrations[i] = std::move(one);
  starts_[i].reset();
  return true;
}

// By the word of the files.
bool StartPlaces::is_trusted(const Start& start) {
  return start.from != kGiven && recorded_.word().is_trusted();
}

// Of files that are trusted this one is not; a guess is dropped.
void StartPlaces::refuse_recorded(std::size_t i, const Registrations& registrations,
                                  Registrations& abstentions) {
  const Start start = std::move(*starts_[i]);
  starts_[i].reset();
  if (start.from == kOneFrame) return;
  ScanRegistration& one = *abstentions[i];
  const auto seen = scan_to_scan_.look(i, start.world_from_scan, registrations);
  one.how = start.from;
  one.on_scans = seen.on_scans;
  one.on_scans->start = start.from;
  one.refusal = fmt::format(
      "the other scans contradict the pose in its file: {:.0f} % of the scan's area are seen through there, "
      "and {:.0f} % lie on surfaces of others, while the files' poses of {} scans agree with what these see "
      "of each other; check it, or give a pose in the scene file",
      100 * seen.through, 100 * seen.on_scans.icp.icp.overlap, recorded_.word().agree);
}

void StartPlaces::place(Registrations& registrations, Registrations& abstentions) {
  for (std::size_t i = 0; i < starts_.size(); ++i)
    if (starts_[i] && is_trusted(*starts_[i])) refuse_recorded(i, registrations, abstentions);
  place_down_to(0, registrations, abstentions);
  for (std::size_t i = 0; i < starts_.size(); ++i)
    if (starts_[i]) settle(i, registrations, abstentions);
}

void StartPlaces::place_down_to(double least_overlap, Registrations& registrations,
                                Registrations& abstentions) {
  for (const double least : kOverlaps) {
    if (least < least_overlap) return;
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < starts_.size(); ++i)
        again |= starts_[i] && place_one(i, least, registrations, abstentions);
    }
  }
}

}  // namespace hybrid::batch
