#pragma once
#include <filesystem>
#include <string>

#include "batch/scene_run.hpp"

namespace hybrid::report {

// report/: registration-before.png and -after.png (the paper's figures 3 and 4: every scan in its colour on
// the proxy, seen from above with the faces turned away left out) and index.html, one page without scripts or
// outside requests that shows all pictures and figures of the run.
void write_report(device::Queue& queue, const batch::SceneRun& run, const std::filesystem::path& out);

// What a person reads on stdout after a run: a line per scan and view, where the pictures are.
std::string text_summary(const batch::SceneRun& run, const std::filesystem::path& out);

}  // namespace hybrid::report
