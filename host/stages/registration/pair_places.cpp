#include "stages/registration/pair_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

// So many times as much as a place may have contradicts one. An eighth of the samples tells, too, where there
// is once more so many times as much, and where planes lay a place, which they do within centimetres.
constexpr double kTimes = 2, kTimesOfFew = kTimes * kTimes;
// With less of no plane to compare, as a share of the scan's area, that says nothing.
constexpr double kFreeSays = 0.002;
// So ICP's gate need not be wide, in overlap_m.
constexpr double kPairGate = 6;
// A place that overlaps by less than this share of the best one is none: nothing speaks for it; and one that
// nothing holds along a direction, as ground and a wall lie on any other such, by less than that.
constexpr double kLeastRival = 0.5, kLeastSliding = 0.8;
// Ends of ICP this near are one place.
constexpr double kSamePair_m = 0.05, kSamePairDeg = 0.5;

double overlap_of(const ScanIcp& found) {
  return found.others.front().overlap;
}

bool free_says(const ScanIcp& found, const IcpScan& scan) {
  return found.free_m2 > kFreeSays * scan.area_m2;
}

// By samples of no plane alone.
bool free_contradicts(const ScanIcp& found, const IcpScan& scan, const PairPlaceOptions& options,
                      double times) {
  return free_says(found, scan) && found.free_seen_through > times * options.most_free_through;
}

bool is_contradicted(const ScanIcp& found, const IcpScan& scan, const PairPlaceOptions& options,
                     double times = kTimes) {
  return found.seen_through > times * options.most_through ||
         (free_says(found, scan) && alike_through(found) > times * options.most_alike_through) ||
         free_contradicts(found, scan, options, times);
}

bool is_one_place(const ScanIcp& a, const ScanIcp& b) {
  return difference(a.icp.world_from_scan, b.icp.world_from_scan).within(kSamePair_m, kSamePairDeg * kDegree);
}

bool is_held(const ScanIcp& found, const PairPlaceOptions& options) {
  return found.icp.degenerate.empty() && found.planes.weakest().share >= options.least_held;
}

bool fits(const ScanIcp& found, const IcpScan& scan, const PairPlaceOptions& options) {
  return found.icp.converged && is_held(found, options) && !is_contradicted(found, scan, options, 1) &&
         overlap_of(found) >= options.least_overlap && found.free_m2 >= options.least_free * scan.area_m2 &&
         found.planes.farthest_m <= options.most_off_m && found.planes.beside() <= options.most_beside;
}

}  // namespace

double alike_through(const ScanIcp& found) {
  return std::sqrt(found.seen_through * found.free_seen_through);
}

PairPlaces tell_places(device::Queue& queue, const IcpScan& scan, const PlacedScan& other,
                       const std::vector<Pose>& places, const PairPlaceOptions& options) {
  const std::vector<PlacedScan> on = {other};
  ScanIcpOptions icp = options.icp;
  icp.gate_m = kPairGate * icp.overlap_m;
  ScanIcpOptions few = icp;
  few.few = true;
  const auto free_is_enough = [&](const ScanIcp& found) {
    return free_contradicts(found, scan, options, kTimesOfFew);
  };
  PairPlaces result;
  for (const Pose& place : places) {
    const ScanIcp here = compare_on_scans(queue, scan, on, place, few, free_is_enough);
    if (is_contradicted(here, scan, options, kTimesOfFew)) continue;
    const ScanIcp near = register_to_scans(queue, scan, on, place, few);
    if (is_contradicted(near, scan, options, kTimesOfFew)) continue;
    ScanIcp found = register_to_scans(queue, scan, on, near.icp.world_from_scan, icp);
    if (is_contradicted(found, scan, options)) continue;
    const bool known = std::any_of(result.open.begin(), result.open.end(),
                                   [&](const ScanIcp& one) { return is_one_place(one, found); });
    if (!known) result.open.push_back(std::move(found));
  }
  const auto rank = [&](const ScanIcp& one) {
    return std::pair(!fits(one, scan, options), alike_through(one));
  };
  std::stable_sort(result.open.begin(), result.open.end(),
                   [&](const ScanIcp& a, const ScanIcp& b) { return rank(a) < rank(b); });
  if (result.open.empty()) return result;
  for (const ScanIcp& one : result.open) result.uncontradicted.push_back(one.icp.world_from_scan);
  const double best = overlap_of(result.open.front());
  std::erase_if(result.open, [&](const ScanIcp& one) {
    return overlap_of(one) < (is_held(one, options) ? kLeastRival : kLeastSliding) * best;
  });
  result.fits = fits(result.open.front(), scan, options);
  return result;
}

}  // namespace hybrid::stages
