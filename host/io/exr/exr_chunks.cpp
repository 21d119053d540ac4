#include "io/exr/exr_chunks.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "io/exr/exr_dwa.hpp"

namespace hybrid::io {
namespace {

// Multiples of `step` from `low` to `high`.
std::uint64_t multiples(int step, int low, int high) {
  const auto floor_of = [&](std::int64_t at) { return at >= 0 ? at / step : -((step - 1 - at) / step); };
  return static_cast<std::uint64_t>(floor_of(high) - floor_of(std::int64_t{low} - 1));
}

// Runs: a count below 0 and as many bytes; else a byte that is repeated so often and once more.
std::uint64_t expanded_runs(std::span<const char> chunk) {
  std::uint64_t bytes = 0;
  for (std::size_t at = 0; at < chunk.size();) {
    const int count = static_cast<signed char>(chunk[at]);
    bytes += static_cast<std::uint64_t>(count < 0 ? -count : count + 1);
    at += count < 0 ? 1 + static_cast<std::size_t>(-count) : 2;
  }
  return bytes;
}

}  // namespace

ExrSamples exr_samples(const Imf::Channel& channel, const ExrChunkBox& box) {
  return {multiples(channel.xSampling, box.left, box.right),
          multiples(channel.ySampling, box.top, box.bottom), channel.type == Imf::HALF ? 2u : 4u};
}

std::uint64_t exr_inflated_bytes(std::span<const char> deflated, std::uint64_t most) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::vector<char> pixels(most);
  std::size_t size = 0;
  const auto result = libdeflate_zlib_decompress(inflater.get(), deflated.data(), deflated.size(),
                                                 pixels.data(), pixels.size(), &size);
  return result == LIBDEFLATE_SUCCESS ? size : most;
}

std::string exr_chunk_problem(Imf::Compression compression, const Imf::ChannelList& channels,
                              const ExrChunkBox& box, std::span<const char> chunk) {
  std::uint64_t expected = 0;
  for (auto at = channels.begin(); at != channels.end(); ++at)
    expected += exr_samples(at.channel(), box).bytes();
  if (chunk.size() >= expected) return {};  // not compressed
  std::uint64_t found = expected;
  switch (compression) {
    case Imf::NO_COMPRESSION:
      found = chunk.size();
      break;
    case Imf::RLE_COMPRESSION:
      found = expanded_runs(chunk);
      break;
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
      if (!chunk.empty()) found = exr_inflated_bytes(chunk, expected);
      break;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      if (!chunk.empty()) {
        const ExrChunkBytes least = dwa_chunk_bytes(channels, box, chunk);
        expected = least.expected;
        found = least.found;
      }
      break;
    default:
      break;
  }
  if (chunk.empty()) found = 0;
  if (found >= expected) return {};
  return exr_chunk_size_problem(box, expected, found);
}

std::string exr_chunk_size_problem(const ExrChunkBox& box, std::uint64_t expected, std::uint64_t found) {
  return fmt::format("expected {} bytes of pixels in {} x {} from ({}, {}), found {}", expected,
                     box.right - box.left + 1, box.bottom - box.top + 1, box.left, box.top, found);
}

int exr_block_lines(Imf::Compression compression) {
  constexpr std::array kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return kLines.at(static_cast<std::size_t>(compression));
}

}  // namespace hybrid::io
