#pragma once
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/exr/exr_stream.hpp"

namespace hybrid::io {

// Channels that compress alike.
struct ExrPart {
  std::string name;
  Imf::Compression compression;  // none or ZIP
  std::vector<std::string> channels;
};

// Writes a flat image as the tiled parts of an OpenEXR file (OpenEXR File Layout, 2013), each with its own
// compression, in bands of whole tiles from the top. One part alone makes a file that is none of parts, which
// every reader reads. A part none of whose channels is in the header is left out; the attributes go into the
// first. Tiles are put together and deflated on the host's threads, with libdeflate, and stand in the file in
// their order: the same bytes for any number of threads.
class ExrTileWriter {
 public:
  // `header`: attributes, channels of float, uint and half without subsampling, tiles, the data window.
  ExrTileWriter(ExrStream& stream, const Imf::Header& header, const std::vector<ExrPart>& parts);

  // Rows of the buffer's slices, whose types are the channels', from `row` on, counted from the top of the
  // data window: a whole number of tiles, but at the image's end.
  void write(const Imf::FrameBuffer& buffer, int row, int count);
  // Where the tiles lie; after the last of them.
  void finish();

 private:
  struct Part {
    Imf::Header header;
    std::vector<std::uint64_t> tile_at;  // row by row
  };
  struct Tile {
    std::size_t part = 0;
    int x = 0, y = 0;  // in tiles
  };

  bool of_parts() const { return parts_.size() > 1; }
  void write_table();
  std::vector<char> encode(const Imf::FrameBuffer& buffer, const Tile& tile) const;

  ExrStream& stream_;
  std::vector<Part> parts_;
  std::uint64_t table_at_ = 0;
  int side_ = 0, across_ = 0;  // of a tile; tiles in a row
};

}  // namespace hybrid::io
