#pragma once
#include "batch/export/export_st_maps.hpp"
#include "batch/render_unit.hpp"
#include "batch/stage_options.hpp"

namespace hybrid::batch {

// scene.rib and what it names: world.rib, shader sources, a slide and a depth picture per photograph. Frames
// are the views that a pinhole camera has, without distortion; of a scene without any, one of the model.
void write_rib_export(stages::Renderer& renderer, const stages::RenderScene& scene,
                      const std::vector<io::SceneView>& views, const PhotographSet& photographs,
                      const StageOptions& options, const std::filesystem::path& folder, const MadeFile& made,
                      const SayNote& note);

}  // namespace hybrid::batch
