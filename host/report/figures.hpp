#pragma once
#include <filesystem>

#include "batch/scene_run.hpp"

namespace hybrid::report {

// The paper's figures 3 and 4: retained samples of all registered scans, one colour each, on the plain proxy,
// before (landmarks or given start) and after ICP. Faces and samples that turn their back to the camera are
// left out, so that one looks into the rooms. Without a model the scans alone under their final poses, as
// above and as a plan.
void write_registration_figures(device::Queue& queue, const batch::SceneRun& run,
                                const std::filesystem::path& folder);

}  // namespace hybrid::report
