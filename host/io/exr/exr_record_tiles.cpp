#include "io/exr/exr_record_tiles.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>

#include "core/parallel.hpp"
#include "io/exr/range_exr_band.hpp"
#include "io/hash_state.hpp"

namespace hybrid::io {
RecordTiles::RecordTiles(const RecordGroup& group, std::span<const RecordChannel> channels) : group_(group) {
  for (const RecordChannel& channel : channels) {
    std::vector<char>& bytes = pixels_.emplace_back(group.pixels() * channel.bytes());
    if (channel.empty != 0 && channel.bytes() == 4)
      std::fill_n(reinterpret_cast<std::uint32_t*>(bytes.data()), group.pixels(), channel.empty);
  }
}

Imf::FrameBuffer RecordTiles::slices(std::span<const RecordChannel> channels) const {
  Imf::FrameBuffer buffer;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const std::size_t step = channels[k].bytes();
    buffer.insert(
        channels[k].name,
        Imf::Slice::Make(channels[k].type, pixels_[k].data(), Imath::V2i(group_.x, group_.y), group_.width,
                         group_.height, step, step * static_cast<std::size_t>(group_.width)));
  }
  return buffer;
}

void RecordTiles::clear_tile(int tile_x, int tile_y, std::span<const RecordChannel> channels) {
  const int x = (tile_x - group_.tile_x) * kRecordTile_px, y = (tile_y - group_.tile_y) * kRecordTile_px;
  const auto width = static_cast<std::size_t>(std::min(kRecordTile_px, group_.width - x));
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (int row = y; row < std::min(y + kRecordTile_px, group_.height); ++row) {
      const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(group_.width) +
                             static_cast<std::size_t>(x);
      if (channels[k].bytes() == 4)
        std::fill_n(words(k) + at, width, channels[k].empty);
      else
        std::fill_n(halves(k) + at, width, std::uint16_t{0});
    }
}

void RecordTiles::hash(std::span<const RecordChannel> channels, int image_tiles_across,
                       std::span<std::uint64_t> tiles) const {
  const auto across = static_cast<std::size_t>(group_.tiles_x);
  parallel_for(across * static_cast<std::size_t>(group_.tiles_y), [&](std::size_t i) {
    const int tile_x = static_cast<int>(i % across), tile_y = static_cast<int>(i / across);
    const int x = tile_x * kRecordTile_px, end_x = std::min(x + kRecordTile_px, group_.width);
    const int y = tile_y * kRecordTile_px, end_y = std::min(y + kRecordTile_px, group_.height);
    const HashState state(XXH3_createState());
    XXH3_64bits_reset(state.get());
    for (std::size_t k = 0; k < channels.size(); ++k)
      for (int row = y; row < end_y; ++row) {
        const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(group_.width) +
                               static_cast<std::size_t>(x);
        XXH3_64bits_update(state.get(), &pixels_[k][at * channels[k].bytes()],
                           static_cast<std::size_t>(end_x - x) * channels[k].bytes());
      }
    tiles[static_cast<std::size_t>(group_.tile_y + tile_y) * static_cast<std::size_t>(image_tiles_across) +
          static_cast<std::size_t>(group_.tile_x + tile_x)] = XXH3_64bits_digest(state.get());
  });
}

std::string tile_sums_text(std::span<const std::uint64_t> tiles) {
  std::string text;
  for (const std::uint64_t sum : tiles) text += fmt::format("{:016x}", sum);
  return text;
}

std::vector<std::uint64_t> parse_tile_sums(std::string_view text, std::size_t tiles) {
  std::vector<std::uint64_t> sums;
  if (text.size() != kTileSum_digits * tiles) return sums;
  for (std::size_t at = 0; at < text.size(); at += kTileSum_digits) {
    const char* const end = text.data() + at + kTileSum_digits;
    std::uint64_t sum = 0;
    if (std::from_chars(text.data() + at, end, sum, 16).ptr != end) return {};
    sums.push_back(sum);
  }
  return sums;
}

std::string records_checksum(std::span<const std::string> texts, std::span<const std::uint64_t> tiles) {
  const HashState state(XXH3_createState());
  XXH3_128bits_reset(state.get());
  for (const std::string& text : texts) XXH3_128bits_update(state.get(), text.c_str(), text.size() + 1);
  XXH3_128bits_update(state.get(), tiles.data(), tiles.size_bytes());
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace hybrid::io
