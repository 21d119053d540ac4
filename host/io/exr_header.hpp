#pragma once
#include <string>
#include <string_view>

namespace hybrid::io {

// Walks the header of a single-part OpenEXR file and checks that every attribute lies within the file and
// that its tiles can: the library allocates by these numbers before it looks at the file's size. Throws
// ErrorKind::input naming the byte.
void check_exr_header(const std::string& file, std::string_view bytes, unsigned tile_px);

}  // namespace hybrid::io
