#include "io/read_cameras.hpp"

#include "core/error.hpp"
#include "io/colmap.hpp"
#include "io/strecha.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;

std::string_view name_of(CameraFormat format) {
  switch (format) {
    case CameraFormat::colmap:
      return "colmap";
    case CameraFormat::strecha:
      return "strecha";
    case CameraFormat::bundler:
      return "bundler";
    case CameraFormat::nerfstudio:
      return "nerfstudio";
  }
  return "";
}

CameraFile read_cameras(const CameraSource& source) {
  switch (source.format) {
    case CameraFormat::colmap:
      return read_colmap(source.path);
    case CameraFormat::strecha:
      return read_strecha(source.path);
    case CameraFormat::bundler:
    case CameraFormat::nerfstudio:
      break;
  }
  fail_input("{}: {} is not supported yet; convert to COLMAP text (cameras.txt, images.txt)",
             source.path.string(), name_of(source.format));
}

std::optional<CameraSource> find_cameras(const fs::path& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) return std::nullopt;
  if (fs::exists(path / "cameras.txt", code) || fs::exists(path / "cameras.bin", code))
    return CameraSource{CameraFormat::colmap, path};
  for (fs::directory_iterator entry(path, code), end; !code && entry != end; entry.increment(code))
    if (entry->path().extension() == ".camera") return CameraSource{CameraFormat::strecha, path};
  return std::nullopt;
}

}  // namespace hybrid::io
