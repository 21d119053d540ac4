#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/polygon_model.hpp"

namespace hybrid::io {

// Wavefront OBJ polygons of any size; negative indices, groups/objects/materials name faces (the last of g,
// o, usemtl; repeated names get -2, -3 ...), CR/LF. `scale` multiplies coordinates (unit = "mm": 0.001); y_up
// turns the model so that Z is up. Throws ErrorKind::input naming file and line: a face index out of range,
// fewer than 3 vertices, a non-finite vertex, no face at all. Faces may be without area. `names`, where
// given, gets what was said of each face.
struct ObjFaceNames {
  std::string group, object, material;
  std::size_t place = 0;   // among the file's faces
  std::uint64_t line = 0;  // in the file
};
PolygonModel read_obj(const std::filesystem::path& file, double scale = 1, bool y_up = false,
                      std::vector<ObjFaceNames>* names = nullptr);
void write_obj(const std::filesystem::path& file, const PolygonModel& model);

}  // namespace hybrid::io
