#pragma once
#include <filesystem>

#include "geometry/image.hpp"

namespace hybrid::io {

// A photograph through OpenImageIO as 8-bit sRGB RGB: 8 or 16 bits per channel, grey or colour; alpha is
// dropped without premultiplying. Throws ErrorKind::input: does not decode or is cut short, size differs from
// the camera's (expected_width 0 = any), floating-point or linear pixels.
// EXIF orientation: camera models may refer to the pixels as stored (COLMAP) or as displayed. A quarter turn
// of a photograph that is not square is settled by the camera's size, whichever way fits; where the size
// cannot tell (half turn, mirror, square, any size) it is an error that says how to settle it.
Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height);

// 1, 3 or 4 channels, sRGB, alpha not premultiplied; no metadata that changes between runs.
void write_png(const std::filesystem::path& file, const Image8& image);

}  // namespace hybrid::io
