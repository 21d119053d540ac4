#pragma once
#include "batch/dry_run.hpp"
#include "batch/planes_run.hpp"
#include "batch/scene_run.hpp"

namespace hybrid::batch {

// Scans (every one that the scene would read, under its id), model with its edits, photographs against their
// cameras; nothing is decoded. Throws ErrorKind::input for what ends the run at its start: scene file, model,
// cameras, folder.
DryRun try_scene(const RunRequest& request);

// The same of single scans.
DryRun try_planes(const PlanesRequest& request);

}  // namespace hybrid::batch
