#pragma once
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/exr_records.hpp"

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
  // XXH3-64 of every tile over its channels, into the image's tiles, row by row.
  void hash(std::span<const RecordChannel> channels, int image_tiles_across,
            std::span<std::uint64_t> tiles) const;

 private:
  RecordGroup group_;
  std::vector<std::vector<char>> pixels_;  // by channel
};

// Over the texts of the header and all tiles, in hexadecimal digits.
std::string records_checksum(std::span<const std::string> texts, std::span<const std::uint64_t> tiles);

}  // namespace hybrid::io
