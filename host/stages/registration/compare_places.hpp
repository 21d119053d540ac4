#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// The evidence that compare_on_scans() finds of a place, of several. Many are asked about with each launch:
// with few samples launches are what takes the time.
std::vector<PlaceEvidence> compare_places(device::Queue& queue, const IcpScan& scan,
                                          const std::vector<PlacedScan>& placed,
                                          const std::vector<Pose>& places,
                                          const ScanIcpOptions& options = {});

}  // namespace hybrid::stages
