#include "io/cameras/colmap.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// Models of COLMAP's mapper lie in folders 0, 1, ... of the one that it is given.
std::string model_below(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    for (const char* name : {"cameras.txt", "cameras.bin"})
      if (std::error_code ignored; fs::exists(entry->path() / name, ignored)) models.push_back(entry->path());
  return models.empty() ? "" : std::min_element(models.begin(), models.end())->string();
}

}  // namespace

CameraFile read_colmap(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) fail_input("{}: no such folder; check the path", folder.string());
  if (!fs::is_directory(folder, code))
    fail_input("{}: expected the folder of a COLMAP model, found a file", folder.string());
  const auto has = [&](const char* name) { return fs::exists(folder / name, code); };
  const bool text = has("cameras.txt") || has("images.txt");
  const bool binary = has("cameras.bin") && has("images.bin");
  if (!text && !has("cameras.bin") && !has("images.bin"))
    if (const std::string below = model_below(folder); !below.empty())
      fail_input(
          "{}: expected cameras.txt and images.txt, or .bin, of a COLMAP model, found none; one is in {}",
          folder.string(), below);
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
