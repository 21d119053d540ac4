#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// Of what compare_on_scans() says of a place, for several: planes, seen_through, free_seen_through and
// free_m2. Many places are asked about with each launch: with few samples launches are what takes the time.
std::vector<ScanIcp> compare_places(device::Queue& queue, const IcpScan& scan,
                                    const std::vector<PlacedScan>& placed, const std::vector<Pose>& places,
                                    const ScanIcpOptions& options = {});

}  // namespace hybrid::stages
