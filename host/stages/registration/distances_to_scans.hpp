#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"

namespace hybrid::stages {

// Some of a scan's samples against the surfaces of other scans: of every n-th row and column, so that there
// are at most about a million.
struct DistancesToScans {
  RangeImage image;                // extent and mask only
  PlaneSegmentation segmentation;  // labels only
  std::vector<float> signed_m;     // world metres, above 0 in front; NaN: no compatible surface within reach
};

// METHOD 6, scan to scan: each measured sample under this pose to the plane through the nearest sample of any
// of the others whose normal is compatible (kernel closest_sample). `reach_m`: world metres; `normal_deg`:
// the largest angle between normals.
DistancesToScans distances_to_scans(device::Queue& queue, const RangeImage& image,
                                    const PlaneSegmentation& segmentation, const Pose& world_from_scan,
                                    const std::vector<PlacedScan>& others, double reach_m, double normal_deg);

}  // namespace hybrid::stages
