#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// Of hypotheses of a scan's pose (world) those that a person may choose from, likeliest first, at most
// `most`, each place once, each after ICP on the placed scans: what lies on their surfaces speaks for a
// place, what is seen through several times as much against it. Those with more than `hopeless_through` of
// that are left out where there is another. Nothing is decided by this. Samples as `options` says.
std::vector<ScanIcp> likely_places(device::Queue& queue, const IcpScan& scan,
                                   const std::vector<PlacedScan>& placed, const std::vector<Pose>& hypotheses,
                                   std::size_t most, const ScanIcpOptions& options, double hopeless_through);

}  // namespace hybrid::stages
