#pragma once
#include <vector>

#include "stages/registration/automatic.hpp"
#include "stages/registration/automatic_offsets.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid::stages {

// A pose after tile ICP, with what its lines of sight say.
struct Finalist {
  TileFit fit;
  std::vector<SightLine> lines;
  SightShares shares;
};

struct Search {
  std::vector<Finalist> finalists;  // highest score first, no two in one place
  int rotations = 0, guesses = 0;
};

// Hypotheses for a scan against a model: rotations, offsets, a coarse look along few lines of sight, tile
// ICP, a closer look along all of them. `scale`: world metres per scan metre.
Search search_poses(SightCaster& caster, const ScanEvidence& scan, const ModelShapes& model, double scale,
                    const AutomaticOptions& options);

// As ProxyModel::motions().
std::vector<Pose> motions_onto_itself(const ModelShapes& model, bool levelled);

// Motions that take much of the model onto itself, applied to the pose: rivals the scan's planes may have
// voted too weakly for, looked at as the finalists were and added to them.
void add_symmetric_rivals(SightCaster& caster, const ScanEvidence& scan, const ModelShapes& model,
                          const std::vector<Pose>& motions, const Pose& pose, const AutomaticOptions& options,
                          Search& search);

SightOptions sight_options(const AutomaticOptions& options);

}  // namespace hybrid::stages
