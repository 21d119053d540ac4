#pragma once
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>

#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_chunks.hpp"

namespace hybrid::io {

// Whether put_exr_pixels() can do what the library does, faster: uncompressed and deflated chunks, channels
// with a sample per pixel, into slices of their own types.
bool can_put_exr_pixels(Imf::Compression compression, const Imf::ChannelList& channels,
                        const Imf::FrameBuffer& slices);

// Puts a chunk's pixels into the slices, the channels without a slice nowhere. Returns what is wrong with the
// chunk, "" where nothing is: then, and only then, slices are written. `room` is memory to use again.
std::string put_exr_pixels(Imf::Compression compression, const Imf::ChannelList& channels,
                           const ExrChunkBox& box, std::span<const char> chunk,
                           const Imf::FrameBuffer& slices, std::vector<char>& room);

// Undoes what OpenEXR does before it deflates: bytes are stored as differences to the one before, plus 128,
// the even ones first. In place of `packed`; both of one size.
void restore_exr_bytes(std::span<char> packed, std::span<char> bytes);

}  // namespace hybrid::io
