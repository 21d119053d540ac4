#include "stages/registration/likely_places.hpp"

#include <algorithm>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kTimesMost = 4;  // so many times as many as are wanted go through ICP
constexpr double kThroughCounts = 4;   // so many times what lies on others
constexpr double kApart_m = 0.3, kApartDeg = 3;

void sort_likeliest_first(std::vector<ScanIcp>& places) {
  const auto score = [](const ScanIcp& one) { return one.icp.overlap - kThroughCounts * one.seen_through; };
  std::stable_sort(places.begin(), places.end(),
                   [&](const ScanIcp& a, const ScanIcp& b) { return score(a) > score(b); });
}

}  // namespace

std::vector<ScanIcp> likely_places(device::Queue& queue, const IcpScan& scan,
                                   const std::vector<PlacedScan>& placed, const std::vector<Pose>& hypotheses,
                                   std::size_t most, const ScanIcpOptions& options, double hopeless_through) {
  if (placed.empty()) return {};
  ScanIcpOptions fewest = options;
  fewest.few = fewest.fewest = true;
  std::vector<ScanIcp> judged;
  for (const Pose& pose : hypotheses) judged.push_back(compare_on_scans(queue, scan, placed, pose, fewest));
  sort_likeliest_first(judged);
  judged.resize(std::min(judged.size(), kTimesMost * most));
  for (ScanIcp& one : judged)
    one = register_to_some(queue, scan, near_scans(placed, one), placed, one.icp.world_from_scan, options);
  sort_likeliest_first(judged);
  std::vector<ScanIcp> best;
  for (ScanIcp& one : judged) {
    const bool known = std::any_of(best.begin(), best.end(), [&](const ScanIcp& other) {
      return difference(other.icp.world_from_scan, one.icp.world_from_scan)
          .within(kApart_m, kApartDeg * kDegree);
    });
    if (known || (one.seen_through > hopeless_through && !best.empty())) continue;
    best.push_back(std::move(one));
    if (best.size() == most) break;
  }
  return best;
}

}  // namespace hybrid::stages
