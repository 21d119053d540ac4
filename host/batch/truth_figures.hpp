#pragma once
#include <nlohmann/json.hpp>

#include "batch/scan_unit.hpp"
#include "io/truth.hpp"

namespace hybrid::batch {

// How far a scan's planes and pose are from a synthetic scene's truth (METHOD, how results are scored): share
// of measured planar samples whose supercluster's majority label is theirs, planes of at least 100 samples
// found (half of their samples right), curved samples called planar, pose error in mm and degrees when a pose
// is given.
nlohmann::ordered_json truth_figures(const io::ScanTruth& truth, const ScanProduct& product,
                                     const Pose* world_from_scan);

}  // namespace hybrid::batch
