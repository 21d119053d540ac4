#pragma once
#include <filesystem>

#include "geometry/image.hpp"

namespace hybrid::io {

// A photograph through OpenImageIO as 8-bit sRGB RGB. Throws ErrorKind::input: does not decode, size differs
// from the camera's (expected_width 0 = any).
Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height);

// 1, 3 or 4 channels, sRGB; no metadata that changes between runs.
void write_png(const std::filesystem::path& file, const Image8& image);

}  // namespace hybrid::io
