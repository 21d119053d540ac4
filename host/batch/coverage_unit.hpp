#pragma once
#include <nlohmann/json.hpp>

#include "batch/render_unit.hpp"
#include "stages/rendering/coverage.hpp"

namespace hybrid::batch {

// What photographs see of the proxy's faces, and where to stand for more, for summary.json.
nlohmann::ordered_json coverage_figures(stages::Renderer& renderer, const stages::RenderScene& scene,
                                        const stages::CoverageOptions& options);

}  // namespace hybrid::batch
