#pragma once
#include "io/input_file.hpp"

namespace hybrid::io {

inline constexpr unsigned kExrLines = 0;  // in place of tile_px: an image in scan lines

// Walks the header of a single-part OpenEXR file in tiles of tile_px x tile_px pixels, or in scan lines, and
// checks that every attribute lies within the file and that its tiles or lines can: the library allocates by
// these numbers before it looks at the file's size. Throws ErrorKind::input naming the byte.
void check_exr_header(InputFile& file, unsigned tile_px);

}  // namespace hybrid::io
