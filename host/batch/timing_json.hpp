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

}  // namespace hybrid::batch
