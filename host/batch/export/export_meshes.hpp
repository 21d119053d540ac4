#pragma once
#include "io/models/gltf.hpp"
#include "stages/rendering/bake_atlas.hpp"

namespace hybrid::batch {

// A mesh per chart, with its place in the atlas; backs are turned round. Contour faces keep their names.
// Throws what triangulate() throws.
std::vector<io::TexturedMesh> textured_meshes(const stages::RenderScene& scene,
                                              const std::vector<stages::AtlasChart>& charts);
// The faces' fronts without pictures.
std::vector<io::TexturedMesh> plain_meshes(const stages::RenderScene& scene);

}  // namespace hybrid::batch
