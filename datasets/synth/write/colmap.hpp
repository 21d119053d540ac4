#pragma once
#include <filesystem>
#include <vector>

#include "trace/camera.hpp"

namespace synth {

// cameras.txt, images.txt (second line of every image empty) and points3D.txt (none); all share one camera.
void write_colmap(const std::filesystem::path& folder, const std::vector<Camera>&);

}  // namespace synth
