#pragma once
#include <filesystem>
#include <optional>
#include <string_view>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

enum class CameraFormat { colmap, strecha, bundler, nerfstudio, e57 };

// "colmap" ...: the key of [photographs] that names the format.
std::string_view name_of(CameraFormat format);

struct CameraSource {
  CameraFormat format = CameraFormat::colmap;
  std::filesystem::path path;  // a folder (colmap, strecha) or a file (bundler, nerfstudio, e57)
};

// `images` is the folder with the photographs: formats that do not give their sizes look there; empty = leave
// such sizes 0. Cameras of an E57 file are in its own frame (e57_photographs.hpp tells more). Throws
// ErrorKind::input naming file and place.
CameraFile read_cameras(const CameraSource& source, const std::filesystem::path& images = {});

// What a path holds, by the names of its files: a folder of one of the formats, bundle.out (*.out) or
// transforms.json (*.json); nothing when it is no camera file at all.
std::optional<CameraSource> find_cameras(const std::filesystem::path& path);

}  // namespace hybrid::io
