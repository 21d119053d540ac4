#pragma once
#include "score/read/scene_truth.hpp"
#include "score/scene_score.hpp"

namespace score {

// The truth's views that DIR/views holds, against its pictures; then the views of photographs that were left
// out (summary.json names them), against these.
std::vector<ViewScore> score_views(const SceneTruth& truth, const std::filesystem::path& results);

}  // namespace score
