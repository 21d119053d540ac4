#pragma once
#include <ImfChannelList.h>

#include <cstdint>
#include <span>

#include "io/exr/exr_chunks.hpp"

namespace hybrid::io {

struct ExrChunkBytes {
  std::uint64_t expected = 0, found = 0;
};

// What a chunk compressed by DWA must hold and holds of the first of its three kinds of data that ends too
// early, in bytes; of the last, where none does. It keeps light (by default R, G, B, Y, RY, BY) as cosines of
// blocks of 8 x 8 pixels, coverage (A) as runs and everything else as it is; which channel is what, a list of
// rules in the chunk says. Of cosines other than a block's mean the library itself finds that they end, but
// in files with more light than one RGB or Y, where it may take those of the channels before.
ExrChunkBytes dwa_chunk_bytes(const Imf::ChannelList& channels, const ExrChunkBox& box,
                              std::span<const char> chunk);

}  // namespace hybrid::io
