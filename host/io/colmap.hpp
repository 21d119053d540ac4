#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::io {

// COLMAP text model (cameras.txt, images.txt), photographs sorted by name. Models: SIMPLE_PINHOLE, PINHOLE,
// SIMPLE_RADIAL, RADIAL, OPENCV; others are an error that names them. Every image takes two lines, the second
// (its 2D points, checked for form only) may be empty but is there. Quaternions within 1 % of unit length are
// normalised. Throws ErrorKind::input naming file and line.
std::vector<Photograph> read_colmap(const std::filesystem::path& folder);

// The cameras of cameras.txt in file order, used by a photograph or not.
struct ColmapCamera {
  std::int64_t id = 0;
  std::string model;  // "SIMPLE_RADIAL" ...
  Camera camera;
  int line = 0;
};
std::vector<ColmapCamera> read_colmap_cameras(const std::filesystem::path& folder);

}  // namespace hybrid::io
