#pragma once
#include <filesystem>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// A Bundler v0.3 file (bundle.out): per camera f k1 k2, R, t; a world point X is seen at p = -P / P.z,
// P = R X + t, at f (1 + k1 |p|^2 + k2 |p|^4) p from the image's centre, y up. Turned into this program's
// camera: the axes y and z change sign, the principal point is (width / 2, height / 2).
// The photographs' names stand in a list of one file per line ("name", or "name 0 focal"), looked for beside
// the file as X.list.txt (for X.bundle.out, COLMAP's form), FILE.list.txt, list.txt, then ../list.txt. Sizes
// are in neither: they are read from the pictures in `images`; empty = leave them 0 (for `hybrid info`).
// Cameras with f = 0 were not registered: left out, with a note. The points are checked for form only.
// Throws ErrorKind::input naming file and line.
CameraFile read_bundler(const std::filesystem::path& file, const std::filesystem::path& images);

}  // namespace hybrid::io
