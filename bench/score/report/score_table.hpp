#pragma once
#include <string>

#include "score/scene_score.hpp"

namespace score {

// Aligned tables for people.
std::string scene_table(const SceneScore& score);
std::string planes_table(const std::vector<std::pair<std::string, const PlaneScore*>>& scans);

}  // namespace score
