#include "io/cameras/read_cameras.hpp"

#include "io/cameras/bundler.hpp"
#include "io/cameras/colmap.hpp"
#include "io/cameras/nerfstudio.hpp"
#include "io/cameras/strecha.hpp"
#include "io/e57/e57_photographs.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

CameraFile read_e57_cameras(const fs::path& file) {
  const E57File opened(file);
  E57Photographs found = e57_photographs(opened.contents());
  CameraFile result;
  result.notes = std::move(found.notes);
  for (E57Photograph& one : found.photographs) {
    const E57Projection projection = opened.contents().images[one.image].projection;
    result.cameras.push_back({one.photograph.name, name_of(projection), one.photograph.camera});
    result.photographs.push_back(std::move(one.photograph));
  }
  return result;
}

}  // namespace

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
    case CameraFormat::e57:
      return "e57";
  }
  return "";
}

CameraFile read_cameras(const CameraSource& source, const fs::path& images) {
  switch (source.format) {
    case CameraFormat::colmap:
      return read_colmap(source.path);
    case CameraFormat::strecha:
      return read_strecha(source.path);
    case CameraFormat::bundler:
      return read_bundler(source.path, images);
    case CameraFormat::nerfstudio:
      return read_nerfstudio(source.path, images);
    case CameraFormat::e57:
      return read_e57_cameras(source.path);
  }
  return {};
}

std::optional<CameraSource> find_cameras(const fs::path& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) {
    if (path.extension() == ".out") return CameraSource{CameraFormat::bundler, path};
    if (path.extension() == ".json") return CameraSource{CameraFormat::nerfstudio, path};
    return std::nullopt;
  }
  if (fs::exists(path / "cameras.txt", code) || fs::exists(path / "cameras.bin", code))
    return CameraSource{CameraFormat::colmap, path};
  if (fs::exists(path / "transforms.json", code))
    return CameraSource{CameraFormat::nerfstudio, path / "transforms.json"};
  if (fs::exists(path / "bundle.out", code)) return CameraSource{CameraFormat::bundler, path / "bundle.out"};
  for (fs::directory_iterator entry(path, code), end; !code && entry != end; entry.increment(code))
    if (entry->path().extension() == ".camera") return CameraSource{CameraFormat::strecha, path};
  return std::nullopt;
}

}  // namespace hybrid::io
