#pragma once
#include <array>
#include <map>
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// What some of a scan's samples say of its places against all scans that have a pose. Places are asked about
// again whenever one more scan has one: what the others said of them is kept.
class PlaceTallies {
 public:
  // Compares all of these places. `scan` and `options` are the same in every call.
  void ask(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
           const std::vector<Pose>& places, const ScanIcpOptions& options);
  // What compare_places() says of one of them on all of `placed`; its shares are of sums, in the order in
  // which the scans came to be placed.
  const PlaceEvidence& of(const Pose& place) const;

 private:
  struct Tally {
    PlaceEvidence sum;
    std::size_t counted = 0;  // of placed_
  };
  void see(const std::vector<PlacedScan>& placed);

  std::vector<PlacedScan> placed_;
  std::map<std::array<double, 8>, Tally> tallies_;  // by the place's numbers
};

}  // namespace hybrid::stages
