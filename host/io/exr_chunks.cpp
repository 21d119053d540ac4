#include "io/exr_chunks.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <set>
#include <string_view>
#include <vector>

#include "io/scalar_type.hpp"

namespace hybrid::io {
namespace {

// Multiples of `step` from `low` to `high`.
std::uint64_t multiples(int step, int low, int high) {
  const auto floor_of = [&](std::int64_t at) { return at >= 0 ? at / step : -((step - 1 - at) / step); };
  return static_cast<std::uint64_t>(floor_of(high) - floor_of(std::int64_t{low} - 1));
}

std::uint64_t bytes_of(const Imf::Channel& channel, const ExrChunkBox& box) {
  return (channel.type == Imf::HALF ? 2u : 4u) * multiples(channel.xSampling, box.left, box.right) *
         multiples(channel.ySampling, box.top, box.bottom);
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

std::uint64_t inflated(std::span<const char> chunk, std::uint64_t most) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::vector<char> pixels(most);
  std::size_t size = 0;
  const auto result = libdeflate_zlib_decompress(inflater.get(), chunk.data(), chunk.size(), pixels.data(),
                                                 pixels.size(), &size);
  // What is no deflated data or too much of it, the library finds.
  return result == LIBDEFLATE_SUCCESS ? size : most;
}

// Whether DWA may keep it as light or as coverage; by the last part of its name.
bool is_light(std::string_view name) {
  static const std::set<std::string, std::less<>> kLight = {"r",   "red", "g",    "grn", "green", "b",
                                                            "blu", "y",   "blue", "a",   "ry",    "by"};
  std::string last(name.substr(name.rfind('.') + 1));
  std::ranges::transform(last, last.begin(), [](unsigned char c) { return std::tolower(c); });
  return kLight.contains(last);
}

// The size of what DWA deflates, of its header of eleven 64-bit numbers the second; the third is its size
// when deflated, and where that is 0 the library skips it.
std::uint64_t deflated_by_dwa(std::span<const char> chunk) {
  const auto number = [&](std::size_t k) { return load_as<std::uint64_t>(chunk.data() + 8 * k, false); };
  return chunk.size() < 88 || number(2) == 0 ? 0 : number(1);
}

}  // namespace

std::string exr_chunk_problem(Imf::Compression compression, const Imf::ChannelList& channels,
                              const ExrChunkBox& box, std::span<const char> chunk) {
  std::uint64_t expected = 0, no_light = 0;
  for (auto at = channels.begin(); at != channels.end(); ++at) {
    expected += bytes_of(at.channel(), box);
    if (!is_light(at.name())) no_light += bytes_of(at.channel(), box);
  }
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
      if (!chunk.empty()) found = inflated(chunk, expected);
      break;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      expected = no_light;
      found = deflated_by_dwa(chunk);
      break;
    default:
      break;
  }
  if (chunk.empty()) found = 0;
  if (found >= expected) return {};
  return fmt::format("expected {} bytes of pixels in {} x {} from ({}, {}), found {}", expected,
                     box.right - box.left + 1, box.bottom - box.top + 1, box.left, box.top, found);
}

int exr_block_lines(Imf::Compression compression) {
  constexpr std::array kLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return kLines.at(static_cast<std::size_t>(compression));
}

}  // namespace hybrid::io
