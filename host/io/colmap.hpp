#pragma once
#include <filesystem>

#include "io/camera_file.hpp"

namespace hybrid::io {

// COLMAP text model (cameras.txt, images.txt), photographs sorted by name. Models: SIMPLE_PINHOLE, PINHOLE,
// SIMPLE_RADIAL, RADIAL, OPENCV; others are an error that names them. Every image takes two lines, the second
// (its 2D points, checked for form only) may be empty but is there. Quaternions within 1 % of unit length are
// normalised. Throws ErrorKind::input naming file and line.
CameraFile read_colmap(const std::filesystem::path& folder);

}  // namespace hybrid::io
