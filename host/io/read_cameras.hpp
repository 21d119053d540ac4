#pragma once
#include <filesystem>
#include <optional>
#include <string_view>

#include "io/camera_file.hpp"

namespace hybrid::io {

enum class CameraFormat { colmap, strecha, bundler, nerfstudio };

// "colmap" ...: the key of [photographs] that names the format.
std::string_view name_of(CameraFormat format);

struct CameraSource {
  CameraFormat format = CameraFormat::colmap;
  std::filesystem::path path;  // a folder (colmap, strecha) or a file
};

// Throws ErrorKind::input naming file and place.
CameraFile read_cameras(const CameraSource& source);

// What a path that is no scan and no model holds, by the names of its files; nothing when it is no camera
// file at all.
std::optional<CameraSource> find_cameras(const std::filesystem::path& path);

}  // namespace hybrid::io
