#pragma once
#include <ImfChannelList.h>
#include <ImfCompression.h>

#include <cstdint>
#include <span>
#include <string>

namespace hybrid::io {

// Pixels of a tile, or of a block of lines, of an OpenEXR file, both ends included.
struct ExrChunkBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

// What a chunk holds of a channel.
struct ExrSamples {
  std::uint64_t wide = 0, high = 0, sample_bytes = 0;
  std::uint64_t bytes() const { return wide * high * sample_bytes; }
};
ExrSamples exr_samples(const Imf::Channel& channel, const ExrChunkBox& box);

// The size of deflated data when inflated, `most` where that is more or the data are damaged, which the
// library finds.
std::uint64_t exr_inflated_bytes(std::span<const char> deflated, std::uint64_t most);

// What is wrong with the bytes that a file holds of a chunk with these channels; "" where they make all of
// its pixels. OpenEXR takes a chunk that ends too early for whole, and for the pixels that it lacks what its
// memory held before. Looked at: empty chunks, of every compression; the size of uncompressed, run-length and
// deflated ones; of DWA what exr_dwa.hpp says. (The library itself finds the end of data in PIZ, PXR24 and
// B44.)
std::string exr_chunk_problem(Imf::Compression compression, const Imf::ChannelList& channels,
                              const ExrChunkBox& box, std::span<const char> chunk);

// In these words.
std::string exr_chunk_size_problem(const ExrChunkBox& box, std::uint64_t expected, std::uint64_t found);

// Lines of a block, by the compression.
int exr_block_lines(Imf::Compression compression);

}  // namespace hybrid::io
