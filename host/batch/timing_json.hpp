#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "batch/progress.hpp"
#include "device/queue.hpp"

namespace hybrid::batch {

// timing.json of SCENE.md: host, device, threads, absolute paths of the inputs and the output folder, seconds
// per stage and per kernel.
nlohmann::ordered_json timing_json(device::Queue& queue, const Progress& progress,
                                   const std::vector<std::filesystem::path>& inputs,
                                   const std::filesystem::path& out);

// DIR/timing.json; with `page`, the same for DIR/report/index.html as a script, since a page opened from the
// disk may load scripts but read no JSON.
void write_timing(const std::filesystem::path& out, const nlohmann::ordered_json& timing, bool page);

}  // namespace hybrid::batch
