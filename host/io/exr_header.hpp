#pragma once
#include "io/input_file.hpp"

namespace hybrid::io {

// In place of tile_px: an image in scan lines; one in lines or in tiles of at most kMostTile_px a side.
inline constexpr unsigned kExrLines = 0, kExrEither = ~0u;
inline constexpr unsigned kMostTile_px = 1024;  // the library holds a row of tiles

// Walks the header of a flat single-part OpenEXR file in tiles of tile_px x tile_px pixels, or in scan lines,
// and checks that every attribute lies within the file and that its tiles or lines can: the library allocates
// by these numbers before it looks at the file's size. Throws ErrorKind::input naming the byte.
void check_exr_header(InputFile& file, unsigned tile_px);

}  // namespace hybrid::io
