#include "io/cameras/colmap.hpp"

#include "core/error.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;

CameraFile read_colmap(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) fail_input("{}: no such folder; check the path", folder.string());
  if (!fs::is_directory(folder, code))
    fail_input("{}: expected the folder of a COLMAP model, found a file", folder.string());
  const auto has = [&](const char* name) { return fs::exists(folder / name, code); };
  const bool text = has("cameras.txt") || has("images.txt");
  const bool binary = has("cameras.bin") && has("images.bin");
  CameraFile result;
  if (binary || (!text && (has("cameras.bin") || has("images.bin")))) {
    result = read_colmap_binary(folder);
    if (text) result.notes.emplace_back("the binary model was read; there is a text model beside it");
  } else {
    result = read_colmap_text(folder);
  }
  sort_photographs(folder, result.photographs);
  return result;
}

}  // namespace hybrid::io
