#pragma once
#include <filesystem>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::io {

// COLMAP text model (cameras.txt, images.txt), photographs sorted by name. Models: SIMPLE_PINHOLE, PINHOLE,
// SIMPLE_RADIAL, RADIAL, OPENCV; others are an error that names them.
std::vector<Photograph> read_colmap(const std::filesystem::path& folder);

}  // namespace hybrid::io
