#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// Where the photographs of cameras lie. A camera's name is a path below [photographs] images. Where
// photographs are missing there, but each of them lies there by the end of its name (day1/IMG_1.jpg or
// IMG_1.jpg for images/day1/IMG_1.jpg, also of names with backslashes), or as JPEG for a PNG, and no two are
// the same file, they are taken from there: names that start at another folder than the one that is given.
struct PhotographFiles {
  std::vector<std::filesystem::path> all;      // one per camera
  std::vector<std::filesystem::path> missing;  // those of `all` that are not there
  std::string note;  // of photographs that are elsewhere than their names say, or ""
};
PhotographFiles find_photographs(const io::SceneFile::Photographs& section,
                                 const std::vector<Photograph>& cameras);

// The same; throws ErrorKind::input naming the first that is missing, how many are, and where the like of it
// is, but in salvage.
PhotographFiles photograph_files(const io::SceneFile::Photographs& section,
                                 const std::vector<Photograph>& cameras, bool salvage = false);

}  // namespace hybrid::batch
