#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "io/scene/scene_file.hpp"

namespace hybrid::archive {

// Files beside a scan that are read with it: extra.ply and the folder of parts of a range image.
std::vector<std::filesystem::path> scan_companions(const std::filesystem::path& scan);

// Every file that a scene's run reads beside the scans and the scene file: model, camera files, photographs,
// truth. Files that are named and not there are among them. Never throws: what cannot be read is for the run
// to say.
std::vector<std::filesystem::path> scene_inputs(const io::SceneFile& scene);

}  // namespace hybrid::archive
