#include "stages/registration/island_places.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

// So many times as much as a place may have contradicts one; with less of no plane to compare, as a share of
// the largest scan's area, that says nothing.
constexpr double kTimesOfIsland = 2.5, kFreeOfIsland = 0.002;
// Pairs that overlap so much are near; ICP is on them, with a gate that need not be wide, in overlap_m.
constexpr double kNearIsland = 0.2, kIslandGate = 6;
// A place that overlaps by less than this share of the best one is none: nothing speaks for it.
constexpr double kLeastOfBest = 0.5;
// Where all of an island lie this near, it is one place.
constexpr double kSameIsland_m = 0.1, kSameIslandDeg = 0.5;

double share(double part, double all) {
  return all > 0 ? part / all : 0;
}

// A fit, and the placed scans near what lies most on them.
struct Judged {
  IslandFit fit;
  std::vector<PlacedScan> near;
};

class IslandTeller {
 public:
  IslandTeller(device::Queue& queue, const std::vector<PlacedScan>& island,
               const std::vector<PlacedScan>& placed, const IslandOptions& options)
      : queue_(queue), island_(island), placed_(placed), options_(options), few_(options.icp) {
    few_.few = true;
    for (const PlacedScan& one : island) area_m2_ = std::max(area_m2_, one.scan->area_m2);
  }

  Judged judge(const Pose& place) const;
  // Once more, after ICP of the scan that lies most on placed ones.
  IslandFit refine(const Judged& judged) const;
  bool is_contradicted(const IslandFit& fit, double times = kTimesOfIsland) const;
  bool fits(const IslandFit& fit) const;
  bool is_one_place(const IslandFit& a, const IslandFit& b) const;

 private:
  device::Queue& queue_;
  const std::vector<PlacedScan>&island_, &placed_;
  const IslandOptions& options_;
  ScanIcpOptions few_;
  double area_m2_ = 0;
};

Judged IslandTeller::judge(const Pose& place) const {
  Judged judged;
  IslandFit& fit = judged.fit;
  fit.world_from_island = place;
  std::vector<double> on_m2(island_.size());
  double most_m2 = 0;
  for (std::size_t i = 0; i < island_.size(); ++i) {
    std::vector<PlacedScan> near;
    for (const PlacedScan& other : placed_) {
      const auto pair =
          compare_on_scans(queue_, *island_[i].scan, {other}, place * island_[i].world_from_scan, few_);
      const ScanOverlap& overlap = pair.others.front();
      fit.all.add(pair);
      fit.overlap = std::max(fit.overlap, overlap.overlap);
      on_m2[i] += overlap.on_m2;
      if (overlap.overlap < kNearIsland) continue;
      fit.near.add(pair);
      near.push_back(other);
    }
    if (on_m2[i] <= most_m2) continue;
    most_m2 = on_m2[i];
    judged.near = std::move(near);
  }
  fit.order.resize(island_.size());
  std::iota(fit.order.begin(), fit.order.end(), std::size_t{0});
  std::stable_sort(fit.order.begin(), fit.order.end(),
                   [&](std::size_t a, std::size_t b) { return on_m2[a] > on_m2[b]; });
  return judged;
}

IslandFit IslandTeller::refine(const Judged& judged) const {
  if (judged.near.empty()) return judged.fit;
  const PlacedScan& most = island_[judged.fit.order.front()];
  ScanIcpOptions all = options_.icp;
  all.gate_m = kIslandGate * all.overlap_m;
  const ScanIcp found = register_to_scans(queue_, *most.scan, judged.near,
                                          judged.fit.world_from_island * most.world_from_scan, all);
  return judge(found.icp.world_from_scan * most.world_from_scan.inverse()).fit;
}

bool IslandTeller::is_contradicted(const IslandFit& fit, double times) const {
  if (fit.all.planes_through() > times * options_.most_through) return true;
  return fit.all.free_m2 > kFreeOfIsland * area_m2_ &&
         (fit.all.alike_through() > times * options_.most_alike_through ||
          fit.all.free_through() > times * options_.most_free_through);
}

bool IslandTeller::fits(const IslandFit& fit) const {
  const SeenByPairs& near = fit.near;
  return !is_contradicted(fit, 1) && fit.overlap >= options_.least_overlap &&
         near.free_m2 >= options_.least_free * area_m2_ &&
         near.planes_through() <= options_.most_near_through &&
         near.alike_through() <= options_.most_near_alike_through &&
         near.free_through() <= options_.most_near_free_through &&
         near.planes.weakest().share >= options_.least_held &&
         near.planes.farthest_m <= options_.most_off_m && near.planes.beside() <= options_.most_beside;
}

bool IslandTeller::is_one_place(const IslandFit& a, const IslandFit& b) const {
  return std::all_of(island_.begin(), island_.end(), [&](const PlacedScan& one) {
    return difference(a.world_from_island * one.world_from_scan, b.world_from_island * one.world_from_scan)
        .within(kSameIsland_m, kSameIslandDeg * kDegree);
  });
}

}  // namespace

void SeenByPairs::add(const ScanIcp& pair) {
  planes.on += pair.planes.on;
  planes.through += pair.planes.through;
  planes.contradicted_m2 += pair.planes.contradicted_m2;
  planes.beside_m2 += pair.planes.beside_m2;
  planes.farthest_m = std::max(planes.farthest_m, pair.planes.farthest_m);
  free_through_m2 += pair.free_seen_through * pair.free_m2;
  free_m2 += pair.free_m2;
}

double SeenByPairs::planes_through() const {
  return share(planes.through.trace(), planes.on.trace() + planes.through.trace());
}

double SeenByPairs::free_through() const {
  return share(free_through_m2, free_m2);
}

double SeenByPairs::alike_through() const {
  return std::sqrt(planes_through() * free_through());
}

std::optional<IslandFit> tell_island_place(device::Queue& queue, const std::vector<PlacedScan>& island,
                                           const std::vector<PlacedScan>& placed,
                                           const std::vector<Pose>& places, const IslandOptions& options) {
  const IslandTeller teller(queue, island, placed, options);
  std::vector<IslandFit> open;
  for (const Pose& place : places) {
    const Judged judged = teller.judge(place);
    if (teller.is_contradicted(judged.fit, kTimesOfIsland * kTimesOfIsland)) continue;
    IslandFit found = teller.refine(judged);
    if (teller.is_contradicted(found)) continue;
    const bool known = std::any_of(open.begin(), open.end(),
                                   [&](const IslandFit& one) { return teller.is_one_place(one, found); });
    if (!known) open.push_back(std::move(found));
  }
  const auto rank = [&](const IslandFit& one) {
    return std::pair(!teller.fits(one), one.all.alike_through());
  };
  const auto best = std::min_element(
      open.begin(), open.end(), [&](const IslandFit& a, const IslandFit& b) { return rank(a) < rank(b); });
  if (best == open.end() || !teller.fits(*best)) return std::nullopt;
  const bool has_rival = std::any_of(open.begin(), open.end(), [&](const IslandFit& one) {
    return &one != &*best && one.overlap >= kLeastOfBest * best->overlap;
  });
  if (has_rival) return std::nullopt;
  return *best;
}

}  // namespace hybrid::stages
