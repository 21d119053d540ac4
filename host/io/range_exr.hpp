#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "geometry/range_image.hpp"

namespace hybrid::io {

// range.exr of SCENE.md: tiled, lossless; channels range, mask, source, x y z, intensity, R G B when present;
// angle tables and `attributes` (strings: source file, hash, pose, crs) in the header, prefixed hybrid:. No
// dates.
void write_range_exr(const std::filesystem::path& file, const RangeImage& image,
                     const std::map<std::string, std::string>& attributes);
// Restores what write_range_exr wrote (extra is not stored here). Throws ErrorKind::input on other or damaged
// files.
RangeImage read_range_exr(const std::filesystem::path& file);

}  // namespace hybrid::io
