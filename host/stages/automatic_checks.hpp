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

// What is wrong with the model as a whole when the best pose has only `supported` of the planar area on
// faces:
// "" or words that say it is inside out or mirrored, because then much more lies on faces. Costs two
// searches.
std::string diagnose_model(device::Queue& queue, const ScanEvidence& scan, const PolygonModel& model,
                           double supported, const AutomaticOptions& options);

// Why the best pose is not accepted, most serious first; "" when it is.
std::string doubts(const TileFit& fit, const AutomaticAlignment& best, const AutomaticOptions& options);

}  // namespace hybrid::stages
