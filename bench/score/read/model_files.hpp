#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "score/geometry.hpp"

namespace score {

using Ring = std::vector<Vec3>;

// The polygons of an OBJ file, world.
std::vector<Ring> read_obj_polygons(const std::filesystem::path& file);

// DIR/model/edited.obj and DIR/model/openings.json; nothing where there is no such file. The latter is what
// `openings = "report"` writes: {"openings": [{"face": name, "ring": [[x, y, z], ...], ...}, ...]}, world,
// metres.
struct EditedModel {
  std::optional<std::vector<Ring>> polygons;
  std::optional<std::vector<Ring>> reported;
};
EditedModel read_edited_model(const std::filesystem::path& results);

}  // namespace score
