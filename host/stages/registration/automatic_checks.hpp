#pragma once
#include <string>
#include <vector>

#include "stages/registration/automatic.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid::stages {

// A model this many times larger than the scan is in other units.
inline constexpr double kSizeRatio = 30;
inline constexpr double kRounded = 1e-3;  // off a scale of 1: of a rotation written with few digits

// Why the scan and the model cannot be aligned automatically at all, in words with a remedy; "" when they
// can: too few planes, parallel planes, sizes that differ as millimetres from metres.
std::string unsuitable(const ScanEvidence& scan, const ModelShapes& model, const AutomaticOptions& options);

// How the model's size and that of the scan, of `scale` world metres a scan metre, differ, in words with a
// remedy; "" where they differ less than `ratio` times.
std::string odd_size(const ScanEvidence& scan, const ModelShapes& model, double scale, double ratio);

std::string nothing_fits(const AutomaticOptions& options);

// What is wrong with the model as a whole when the best pose has only `supported` of the planar area on
// faces:
// "" or words that say it is inside out or mirrored, because then much more lies on faces. Costs two
// searches.
std::string diagnose_model(device::Queue& queue, const ScanEvidence& scan, const PolygonModel& model,
                           double supported, const AutomaticOptions& options);

// What may be wrong when a pose that was given has only `supported` of the planar area on faces: a model of
// another size, inside out or mirrored, or a pose of elsewhere in it; "" when none of these. Costs up to
// three searches.
std::string diagnose_pose(device::Queue& queue, const ScanEvidence& scan, const ProxyModel& model,
                          double scale, double supported, const AutomaticOptions& options);

// What speaks against the best pose, most serious first; "" when nothing does.
std::string doubts(const TileFit& fit, const AutomaticAlignment& best, const AutomaticOptions& options);
// The same of what its rivals have for themselves.
std::string doubts_by_rivals(const AutomaticAlignment& best, const AutomaticOptions& options);

}  // namespace hybrid::stages
