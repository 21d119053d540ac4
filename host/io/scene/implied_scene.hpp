#pragma once
#include <filesystem>
#include <vector>

#include "io/scene/scene_file.hpp"

namespace hybrid::io {

// Scans that lie together and that no scene file describes are a scene all the same: without a model, each
// file an entry. `place` is their folder, or the one file; the scene has its name. Nobody says that they are
// of one place (SceneFile::implied).
SceneFile implied_scene(const std::filesystem::path& place, const std::vector<std::filesystem::path>& scans);

// The scan files in a folder, by name: not in folders below, not hidden ones, no .exr that holds no scan, no
// E57 file of photographs alone, nor what belongs to a range image beside it.
std::vector<std::filesystem::path> scans_in_folder(const std::filesystem::path& folder);

// extra.ply, where one of the files beside it is a range image.
bool belongs_to_range_image(const std::filesystem::path& file,
                            const std::vector<std::filesystem::path>& beside);

// An E57 file with images and no scans: a scene file's [photographs] may name it.
bool holds_photographs_alone(const std::filesystem::path& file);

// scene.toml, or *.scene.toml: what a folder or an archive may stand for.
bool has_scene_name(const std::filesystem::path& file);

// A TOML file with a [[scan]], [model] or [scene] that is called neither scene.toml nor *.scene.toml, and so
// is none that a folder or an archive stands for.
bool is_scene_by_another_name(const std::filesystem::path& file);

// What read_scene_file() takes for a scene file: a folder stands for its scene.toml or for the scans in it,
// a scan file for its scans. Throws ErrorKind::input for a folder that has none, or several scene files, or
// one by another name.
SceneFile read_scene_of(const std::filesystem::path& folder_or_scan);

}  // namespace hybrid::io
