#pragma once
#include <filesystem>
#include <vector>

#include "world/landmarks.hpp"

namespace synth {

void write_scene_toml(const std::filesystem::path&, const World&, const Options&,
                      const std::vector<std::vector<Landmark>>& landmarks_of_scan);

}  // namespace synth
