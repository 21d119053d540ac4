#include "io/exr/exr_pixels.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace hybrid::io {
namespace {

bool is_deflated(Imf::Compression compression) {
  return compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION;
}

// Sums of the bytes so far; the difference of 128 makes every other one, from the second on, 128 more.
void add_up(std::span<char> bytes) {
  std::size_t i = 0;
  unsigned char sum = 0;
#ifdef __SSE2__
  const __m128i every_other = _mm_set1_epi16(static_cast<short>(0x8000));
  for (; i + 16 <= bytes.size(); i += 16) {
    auto* at = reinterpret_cast<__m128i*>(bytes.data() + i);
    __m128i sums = _mm_loadu_si128(at);
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 1));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 2));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 4));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 8));
    sums = _mm_add_epi8(sums, _mm_set1_epi8(static_cast<char>(sum)));
    sum = static_cast<unsigned char>(_mm_extract_epi16(sums, 7) >> 8);
    _mm_storeu_si128(at, _mm_xor_si128(sums, every_other));
  }
#endif
  for (; i < bytes.size(); ++i) {
    sum = static_cast<unsigned char>(sum + static_cast<unsigned char>(bytes[i]));
    bytes[i] = static_cast<char>(i % 2 == 0 ? sum : sum ^ 0x80);
  }
}

void interleave(std::span<const char> halves, std::span<char> bytes) {
  const std::size_t odd = (bytes.size() + 1) / 2, pairs = bytes.size() / 2;
  std::size_t i = 0;
#ifdef __SSE2__
  for (; i + 16 <= pairs; i += 16) {
    const __m128i even = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves.data() + i)),
                  other = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves.data() + odd + i));
    auto* to = reinterpret_cast<__m128i*>(bytes.data() + 2 * i);
    _mm_storeu_si128(to, _mm_unpacklo_epi8(even, other));
    _mm_storeu_si128(to + 1, _mm_unpackhi_epi8(even, other));
  }
#endif
  for (; i < pairs; ++i) {
    bytes[2 * i] = halves[i];
    bytes[2 * i + 1] = halves[odd + i];
  }
  if (odd > pairs) bytes[2 * pairs] = halves[pairs];
}

// Of deflated data; room holds them twice.
std::string unpack(const ExrChunkBox& box, std::span<const char> chunk, std::size_t expected,
                   std::vector<char>& room) {
  room.resize(2 * expected);
  const std::span<char> packed = std::span(room).first(expected), bytes = std::span(room).last(expected);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::size_t size = 0;
  switch (libdeflate_zlib_decompress(inflater.get(), chunk.data(), chunk.size(), packed.data(), expected,
                                     &size)) {
    case LIBDEFLATE_SUCCESS:
      break;
    case LIBDEFLATE_INSUFFICIENT_SPACE:
      return exr_chunk_size_problem(box, expected, expected + 1) + " or more";
    default:
      return chunk.empty() ? exr_chunk_size_problem(box, expected, 0) : "damaged deflated data";
  }
  if (size < expected) return exr_chunk_size_problem(box, expected, size);
  restore_exr_bytes(packed, bytes);
  return {};
}

}  // namespace

bool can_put_exr_pixels(Imf::Compression compression, const Imf::ChannelList& channels,
                        const Imf::FrameBuffer& slices) {
  if (compression != Imf::NO_COMPRESSION && !is_deflated(compression)) return false;
  for (auto at = channels.begin(); at != channels.end(); ++at) {
    const Imf::Channel& channel = at.channel();
    if (channel.xSampling != 1 || channel.ySampling != 1) return false;
    const Imf::Slice* slice = slices.findSlice(at.name());
    if (slice && (slice->type != channel.type || slice->xSampling != 1 || slice->ySampling != 1 ||
                  slice->xTileCoords || slice->yTileCoords))
      return false;
  }
  return true;
}

std::string put_exr_pixels(Imf::Compression compression, const Imf::ChannelList& channels,
                           const ExrChunkBox& box, std::span<const char> chunk,
                           const Imf::FrameBuffer& slices, std::vector<char>& room) {
  const auto wide = static_cast<std::size_t>(box.right - box.left + 1);
  struct Row {
    const Imf::Slice* slice;
    std::size_t bytes;  // of a pixel
  };
  std::vector<Row> rows;
  std::size_t line_bytes = 0;
  for (auto at = channels.begin(); at != channels.end(); ++at) {
    rows.push_back({slices.findSlice(at.name()), at.channel().type == Imf::HALF ? 2u : 4u});
    line_bytes += wide * rows.back().bytes;
  }
  const std::size_t expected = line_bytes * static_cast<std::size_t>(box.bottom - box.top + 1);
  if (chunk.size() > expected || (!is_deflated(compression) && chunk.size() < expected))
    return exr_chunk_size_problem(box, expected, chunk.size());
  const char* from = chunk.data();
  if (chunk.size() < expected) {
    if (std::string problem = unpack(box, chunk, expected, room); !problem.empty()) return problem;
    from = room.data() + expected;
  }
  for (int y = box.top; y <= box.bottom; ++y)
    for (const auto& [slice, bytes] : rows) {
      const std::size_t row_bytes = wide * bytes;
      if (slice) {
        char* to = slice->base +
                   static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(slice->yStride) +
                   static_cast<std::ptrdiff_t>(box.left) * static_cast<std::ptrdiff_t>(slice->xStride);
        if (slice->xStride == bytes)
          std::memcpy(to, from, row_bytes);
        else
          for (std::size_t k = 0; k < wide; ++k)
            std::memcpy(to + k * slice->xStride, from + k * bytes, bytes);
      }
      from += row_bytes;
    }
  return {};
}

void restore_exr_bytes(std::span<char> packed, std::span<char> bytes) {
  add_up(packed);
  interleave(packed, bytes);
}

}  // namespace hybrid::io
