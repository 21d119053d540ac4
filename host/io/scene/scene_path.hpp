#pragma once
#include <vector>

#include "io/scene/scene_file.hpp"
#include "io/scene/scene_table.hpp"

namespace hybrid::io {

// Keys of [[path]].
const SceneTable::Names& scene_path_keys();

// The frames of a [[path]], views named <path>/0000, <path>/0001 ...: a turntable (`centre`, `radius`), or a
// smooth curve through key cameras (`eyes`, `targets`), on which eye and target go at constant speed. Throws
// ErrorKind::input, naming key and line.
std::vector<SceneView> read_scene_path(const std::filesystem::path& file, const SceneTable& table);

}  // namespace hybrid::io
