#include "io/exr/exr_record_index.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/free_memory.hpp"

namespace hybrid::io {

RecordIndex::RecordIndex(const std::string& file, const RecordLayout& layout,
                         const std::vector<RecordGroup>& groups, bool salvage, const std::string& remedy)
    : file_(file),
      layout_(layout),
      groups_(groups),
      salvage_(salvage),
      remedy_(remedy),
      seen_(layout.samples),
      stretch_(groups.size()) {}

template <typename Take>
void RecordIndex::for_records(std::size_t group, const std::uint32_t* source, const Take& take) const {
  const RecordGroup& g = groups_[group];
  const auto cols = static_cast<std::uint32_t>(layout_.cols);
  std::size_t i = 0;
  for (int row = 0; row < g.height; ++row) {
    std::uint32_t pixel = static_cast<std::uint32_t>(g.y + row) * cols + static_cast<std::uint32_t>(g.x);
    for (int col = 0; col < g.width; ++col, ++i, ++pixel)
      if (source[i] != kNowhere) take(source[i], pixel);
  }
}

void RecordIndex::add(std::size_t group, const std::uint32_t* source) {
  Stretch& stretch = stretch_[group];
  for_records(group, source, [&](std::uint32_t record, std::uint32_t pixel) {
    if (record >= layout_.samples || seen_[record])
      fail_input(
          "{}: channel source: row {}, column {}: expected every record from 0 to {} once, found {}; copy or "
          "write the file again, {}",
          file_, pixel / static_cast<std::uint32_t>(layout_.cols),
          pixel % static_cast<std::uint32_t>(layout_.cols), layout_.samples - 1, record, remedy_);
    seen_[record] = true;
    ++placed_;
    stretch.first = std::min<std::uint64_t>(stretch.first, record);
    stretch.end = std::max<std::uint64_t>(stretch.end, record + std::uint64_t{1});
  });
}

bool RecordIndex::wants_all() const {
  std::uint64_t sum = 0;
  for (const Stretch& stretch : stretch_) sum += stretch.end > 0 ? stretch.end - stretch.first : 0;
  return sum > 2 * layout_.samples;
}

void RecordIndex::check_same(bool same) const {
  if (!same)
    fail_input(
        "{}: channel source: expected the records that were there when it was opened, found others; the "
        "file was changed meanwhile: read it again",
        file_);
}

void RecordIndex::keep(std::size_t group, const std::uint32_t* source) {
  pixel_of_.resize(layout_.samples, kNowhere);
  for_records(group, source, [&](std::uint32_t record, std::uint32_t pixel) {
    check_same(record < layout_.samples);
    pixel_of_[record] = pixel;
  });
}

void RecordIndex::load(std::size_t group, const std::uint32_t* source) {
  if (keeps_all()) return;
  Stretch& stretch = stretch_[group];
  stretch.pixel_of.assign(stretch.end > 0 ? stretch.end - stretch.first : 0, kNowhere);
  for_records(group, source, [&](std::uint32_t record, std::uint32_t pixel) {
    check_same(record >= stretch.first && record < stretch.end);
    stretch.pixel_of[record - stretch.first] = pixel;
  });
}

void RecordIndex::unload(std::size_t group) {
  free_memory(stretch_[group].pixel_of);
}

const std::uint32_t* RecordIndex::pixels(std::uint64_t first, std::size_t count) {
  if (keeps_all()) {
    const std::span block(&pixel_of_[first], count);
    check_same(salvage_ || std::ranges::find(block, kNowhere) == block.end());
    return block.data();
  }
  block_.assign(count, kNowhere);
  for (const Stretch& stretch : stretch_) {
    if (stretch.pixel_of.empty()) continue;
    const std::uint64_t begin = std::max(first, stretch.first), end = std::min(first + count, stretch.end);
    for (std::uint64_t record = begin; record < end; ++record)
      if (const std::uint32_t pixel = stretch.pixel_of[record - stretch.first]; pixel != kNowhere)
        block_[record - first] = pixel;
  }
  check_same(salvage_ || std::ranges::find(block_, kNowhere) == block_.end());
  return block_.data();
}

}  // namespace hybrid::io
