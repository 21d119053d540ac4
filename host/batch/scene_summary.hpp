#pragma once
#include <nlohmann/json.hpp>

#include "batch/scene_run.hpp"
#include "io/truth.hpp"

namespace hybrid::batch {

// What summary.json says of each scan: figures of its planes, its registration or why it has none, and,
// against a synthetic scene's truth, how right they are. Truth of another file scores nothing, with a
// warning.
nlohmann::ordered_json scan_summaries(const SceneRun& run, const io::SceneTruth* truth);

}  // namespace hybrid::batch
