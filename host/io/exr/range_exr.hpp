#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "geometry/range_image.hpp"

namespace hybrid::io {

// range.exr of SCENE.md: tiled, lossless; channels range, mask, source, x y z, intensity, R G B when present
// (half, linear light: sRGB bytes come back exactly); angle tables, the number of `extra` samples (which are
// in extra.ply beside it) and `attributes` (strings: source file, hash, pose as world_from_scan, crs) in the
// header, prefixed hybrid:. No dates: the same image gives the same bytes. Throws ErrorKind::failed for an
// image without samples, vectors of other lengths than rows x cols, or attributes named as the format's own.
// Other programs' range images, and this one as a scan: exr_scan.hpp.
void write_range_exr(const std::filesystem::path& file, const RangeImage& image,
                     const std::map<std::string, std::string>& attributes);
// Restores what write_range_exr wrote, bit by bit (but the list `extra`). Throws ErrorKind::input on
// other or damaged files; a checksum over the content finds what the compression does not.
RangeImage read_range_exr(const std::filesystem::path& file);
// The strings given to write_range_exr, without the prefix.
std::map<std::string, std::string> read_range_exr_attributes(const std::filesystem::path& file);

}  // namespace hybrid::io
