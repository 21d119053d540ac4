#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::batch {

// Where the export puts a file of this name; what it says of things left out.
using MadeFile = std::function<std::filesystem::path(const std::string&)>;
using SayNote = std::function<void(const std::string&)>;

// st/<camera>-undistort.exr and -distort.exr (R = s, G = t, see geometry/st_map.hpp), one pair per different
// camera with distortion, and st/cameras.json, which tells each photograph's maps and pinhole camera. Says
// when there is none.
void write_st_maps(const std::vector<Photograph>& photographs, const MadeFile& made, const SayNote& note);

}  // namespace hybrid::batch
