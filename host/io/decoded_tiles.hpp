#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/scratch_file.hpp"
#include "io/exr/exr_record_tiles.hpp"

namespace hybrid::io {

// Some channels of an image's groups of tiles as they were decoded, in a scratch file: decoding takes a
// hundred times as long as reading them there. As far as there is room on disk.
class DecodedTiles {
 public:
  // `channels`: the numbers of those to keep, of 32 bits each, ascending. Refers to `groups`.
  DecodedTiles(const std::vector<RecordGroup>& groups, std::vector<std::size_t> channels);

  // `tiles` with all channels of the image.
  void put(std::size_t group, const RecordTiles& tiles);
  // Fills `tiles`, which have the channels with these numbers. False where they must be decoded again.
  bool get(std::size_t group, std::span<const std::size_t> channels, RecordTiles& tiles) const;

 private:
  std::uint64_t offset(std::size_t group, std::size_t slot) const {
    return begin_[group] + std::uint64_t{slot} * groups_[group].pixels() * 4;
  }

  const std::vector<RecordGroup>& groups_;
  std::vector<std::size_t> channels_;
  std::vector<std::uint64_t> begin_;  // of each group
  std::vector<bool> kept_;            // the same
  std::unique_ptr<ScratchFile> file_;
};

}  // namespace hybrid::io
