#include "stages/registration/place_tallies.hpp"

#include <algorithm>

#include "stages/registration/compare_places.hpp"

namespace hybrid::stages {
namespace {

std::array<double, 8> numbers_of(const Pose& pose) {
  const Eigen::Vector4d turn = pose.rotation.coeffs();
  const Vec3& t = pose.translation;
  return {pose.scale, turn(0), turn(1), turn(2), turn(3), t.x(), t.y(), t.z()};
}

bool is_same(const PlacedScan& a, const PlacedScan& b) {
  return a.scan == b.scan && numbers_of(a.world_from_scan) == numbers_of(b.world_from_scan);
}

bool holds(const std::vector<PlacedScan>& list, const PlacedScan& one) {
  return std::any_of(list.begin(), list.end(), [&](const PlacedScan& other) { return is_same(other, one); });
}

}  // namespace

// A scan that is placed no more, or elsewhere, was told of in another frame: nothing that is kept holds.
void PlaceTallies::see(const std::vector<PlacedScan>& placed) {
  const bool all_stay = std::all_of(placed_.begin(), placed_.end(),
                                    [&](const PlacedScan& known) { return holds(placed, known); });
  if (!all_stay) {
    placed_.clear();
    tallies_.clear();
  }
  if (placed_.size() == placed.size()) return;
  for (const PlacedScan& one : placed)
    if (!holds(placed_, one)) placed_.push_back(one);
}

void PlaceTallies::ask(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
                       const std::vector<Pose>& places, const ScanIcpOptions& options) {
  see(placed);
  // By how many of the scans have been counted.
  std::map<std::size_t, std::vector<Pose>> lacking;
  for (const Pose& place : places)
    if (const Tally& tally = tallies_[numbers_of(place)]; tally.counted < placed_.size())
      lacking[tally.counted].push_back(place);
  for (const auto& [counted, some] : lacking) {
    const std::vector<PlacedScan> more(placed_.begin() + static_cast<std::ptrdiff_t>(counted), placed_.end());
    const auto compared = compare_places(queue, scan, more, some, options);
    for (std::size_t k = 0; k < some.size(); ++k) {
      Tally& tally = tallies_[numbers_of(some[k])];
      if (tally.counted == placed_.size()) continue;  // one that is asked about twice
      tally.sum += compared[k];
      tally.counted = placed_.size();
    }
  }
}

const PlaceEvidence& PlaceTallies::of(const Pose& place) const {
  return tallies_.at(numbers_of(place)).sum;
}

}  // namespace hybrid::stages
