#include "io/decoded_tiles.hpp"

#include <algorithm>

namespace hybrid::io {

DecodedTiles::DecodedTiles(const std::vector<RecordGroup>& groups, std::vector<std::size_t> channels)
    : groups_(groups), channels_(std::move(channels)), kept_(groups.size()) {
  std::uint64_t end = 0;
  for (const RecordGroup& group : groups_) {
    begin_.push_back(end);
    end += std::uint64_t{4} * group.pixels() * channels_.size();
  }
  file_ = ScratchFile::make(end);
}

void DecodedTiles::put(std::size_t group, const RecordTiles& tiles) {
  if (!file_) return;
  kept_[group] = true;
  for (std::size_t slot = 0; slot < channels_.size() && kept_[group]; ++slot)
    kept_[group] = file_->write(offset(group, slot), tiles.bytes(channels_[slot]));
  if (!kept_[group]) file_.reset();  // gives the room back, with what is kept of other groups
}

bool DecodedTiles::get(std::size_t group, std::span<const std::size_t> channels, RecordTiles& tiles) const {
  if (!file_ || !kept_[group]) return false;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto slot = std::ranges::lower_bound(channels_, channels[k]);
    if (slot == channels_.end() || *slot != channels[k]) return false;
    if (!file_->read(offset(group, static_cast<std::size_t>(slot - channels_.begin())), tiles.bytes(k)))
      return false;
  }
  return true;
}

}  // namespace hybrid::io
