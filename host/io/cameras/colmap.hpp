#pragma once
#include <filesystem>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// A COLMAP model's cameras and images: cameras.bin and images.bin where both are there (as COLMAP itself
// chooses), else cameras.txt and images.txt. Points are not read. Models: SIMPLE_PINHOLE, PINHOLE,
// SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE; others
// are an error that names them. Quaternions within 1 % of unit length are normalised. Names may lie in
// subfolders. Throws ErrorKind::input naming file and line, or file and byte.
CameraFile read_colmap(const std::filesystem::path& folder);

// The two forms by themselves. In text every image takes two lines, the second (its 2D points, checked for
// form only) may be empty but is there.
CameraFile read_colmap_text(const std::filesystem::path& folder);
CameraFile read_colmap_binary(const std::filesystem::path& folder);

}  // namespace hybrid::io
