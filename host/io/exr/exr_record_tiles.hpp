#pragma once
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_records.hpp"

namespace hybrid::io {

struct RecordChannel {
  std::string name;
  Imf::PixelType type = Imf::UINT;
  std::uint32_t empty = 0;  // bits of a node without a record
  std::size_t bytes() const { return type == Imf::HALF ? 2 : 4; }
};

// The pixels of one group in memory, some or all channels.
class RecordTiles {
 public:
  RecordTiles(const RecordGroup& group, std::span<const RecordChannel> channels);

  const RecordGroup& group() const { return group_; }
  std::uint32_t* words(std::size_t channel) {
    return reinterpret_cast<std::uint32_t*>(pixels_[channel].data());
  }
  const std::uint32_t* words(std::size_t channel) const {
    return reinterpret_cast<const std::uint32_t*>(pixels_[channel].data());
  }
  std::uint16_t* halves(std::size_t channel) {
    return reinterpret_cast<std::uint16_t*>(pixels_[channel].data());
  }

  std::span<char> bytes(std::size_t channel) { return pixels_[channel]; }
  std::span<const char> bytes(std::size_t channel) const { return pixels_[channel]; }

  // For the library; valid while this lives.
  Imf::FrameBuffer slices(std::span<const RecordChannel> channels) const;
  // Makes every node of one of the image's tiles one without a record.
  void clear_tile(int tile_x, int tile_y, std::span<const RecordChannel> channels);
  // XXH3-64 of every tile over its channels, into the image's tiles, row by row.
  void hash(std::span<const RecordChannel> channels, int image_tiles_across,
            std::span<std::uint64_t> tiles) const;

 private:
  RecordGroup group_;
  std::vector<std::vector<char>> pixels_;  // by channel
};

// All tiles' checksums as an attribute's text, and back; none where that holds others than so many.
inline constexpr std::size_t kTileSum_digits = 16;
std::string tile_sums_text(std::span<const std::uint64_t> tiles);
std::vector<std::uint64_t> parse_tile_sums(std::string_view text, std::size_t tiles);

// Over the texts of the header and all tiles, in hexadecimal digits.
std::string records_checksum(std::span<const std::string> texts, std::span<const std::uint64_t> tiles);

}  // namespace hybrid::io
