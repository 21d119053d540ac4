#pragma once
#include <string>

#include "io/input_file.hpp"

namespace hybrid::io {

inline constexpr unsigned kMostTile_px = 1024;  // the library holds a row of tiles

struct ExrHeaderFacts {
  std::string format{};   // the first part's text attribute hybrid:format, or "": which reader is to open it
  std::uint64_t end = 0;  // the byte behind the headers, where the table of offsets begins
  bool several = false;   // written as parts, be it one
};

// Walks the headers of a flat OpenEXR file, in one or several parts of one size, each in tiles of at most
// kMostTile_px a side or in scan lines, and checks that every attribute lies within the file and that the
// tiles or lines can: the library allocates by these numbers before it looks at the file's size. Throws
// ErrorKind::input naming the byte.
ExrHeaderFacts check_exr_header(InputFile& file);

}  // namespace hybrid::io
