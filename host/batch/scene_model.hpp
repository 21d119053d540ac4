#pragma once
#include <vector>

#include "geometry/polygon_model.hpp"
#include "io/models/obj.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// In metres, Z up, without the scene's shift; `names`: per face, what the file calls it. Faces without an
// area, which meshes have, are left out with a warning that names the first of them. Throws ErrorKind::input
// as io::read_obj() does, and when no other face is there.
PolygonModel read_scene_model(const io::SceneFile::Model& section, std::vector<io::ObjFaceNames>& names);

// Throws ErrorKind::input naming file and line of the first face whose outlines cross: of the model as it is
// after edits, whose faces go by the names that they were read with.
void check_outlines(const io::SceneFile::Model& section, const PolygonModel& read,
                    const std::vector<io::ObjFaceNames>& names, const PolygonModel& edited);

}  // namespace hybrid::batch
