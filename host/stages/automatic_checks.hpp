#pragma once
#include <string>
#include <vector>

#include "stages/automatic.hpp"
#include "stages/tile_icp.hpp"

namespace hybrid::stages {

// Why the scan and the model cannot be aligned automatically at all, in words with a remedy; "" when they
// can: too few planes, parallel planes, sizes that differ as millimetres from metres.
std::string unsuitable(const ScanEvidence& scan, const ModelShapes& model, const AutomaticOptions& options);

std::string nothing_fits();

// Why the best pose is not accepted, most serious first; "" when it is.
std::string doubts(const TileFit& fit, const SightShares& shares, const std::vector<RivalPose>& rivals,
                   const AutomaticOptions& options);

}  // namespace hybrid::stages
