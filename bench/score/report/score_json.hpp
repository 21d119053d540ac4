#pragma once
#include <nlohmann/json.hpp>

#include "score/scene_score.hpp"

namespace score {

nlohmann::ordered_json scene_json(const SceneScore& score, const ScoreOptions& options);
nlohmann::ordered_json planes_json(const PlaneScore& score);

}  // namespace score
