#include "io/e57/lost_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>
#include <vector>

#include "io/e57/little_endian.hpp"
#include "io/e57/packets.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kChunk_bytes = 1020 << 10, kOverlap_bytes = 1020;
constexpr std::size_t kMostTold = 8;

// Calls take(offset, bytes) over the whole file in chunks that overlap, until it returns true.
void for_chunks(const PagedFile& file, const std::function<bool(std::uint64_t, std::string_view)>& take) {
  std::vector<char> bytes;
  for (std::uint64_t at = 0; at < file.size(); at += kChunk_bytes) {
    bytes.resize(std::min(kChunk_bytes + kOverlap_bytes, file.size() - at));
    std::vector<std::uint64_t> bad_pages;
    file.read(at, bytes, &bad_pages);
    if (take(at, {bytes.data(), bytes.size()})) return;
  }
}

std::optional<std::uint64_t> find(const PagedFile& file, std::string_view text, std::uint64_t from) {
  std::optional<std::uint64_t> found;
  for_chunks(file, [&](std::uint64_t at, std::string_view bytes) {
    if (at + bytes.size() <= from) return false;
    const std::size_t place = bytes.find(text, from > at ? from - at : 0);
    if (place != bytes.npos) found = at + place;
    return found.has_value();
  });
  return found;
}

// A table's section at the start of `bytes`, which lie at `at`.
bool is_table(const PagedFile& file, std::uint64_t at, std::string_view bytes) {
  if (bytes.size() < kSectionHeader_bytes || load<std::uint64_t>(bytes.data()) != 1) return false;
  const auto length = load<std::uint64_t>(bytes.data() + 8), data = load<std::uint64_t>(bytes.data() + 16);
  const std::uint64_t behind = at + kSectionHeader_bytes;
  return length >= kSectionHeader_bytes && length < std::uint64_t{1} << 48 && data > 0 &&
         data % PagedFile::kPage_bytes < PagedFile::kPayload_bytes && data >= PagedFile::physical(behind) &&
         data - PagedFile::physical(behind) <= length + length / 128 &&
         PagedFile::physical(behind) < PagedFile::physical(file.size());
}

// Of the first data packet in `bytes`, or 0.
std::uint32_t streams_of(std::string_view bytes) {
  if (bytes.size() < kPacketHeader_bytes) return 0;
  const PacketHeader header = packet_header(bytes.data());
  return header.type == PacketHeader::data ? header.streams : 0;
}

}  // namespace

std::optional<E57Stretch> find_description(const PagedFile& file) {
  const auto root = find(file, "<e57Root", 0);
  if (!root) return {};
  constexpr std::string_view kEnd = "</e57Root>";
  const auto end = find(file, kEnd, *root);
  return E57Stretch{*root, (end ? *end + kEnd.size() : file.size()) - *root};
}

std::string tell_tables(const PagedFile& file) {
  std::vector<std::string> told;
  std::uint64_t next = kFileHeader_bytes, count = 0;
  for_chunks(file, [&](std::uint64_t at, std::string_view bytes) {
    // Sections start at multiples of four.
    for (std::uint64_t place = std::max((at + 3) / 4 * 4, next); place < at + bytes.size(); place += 4) {
      const std::string_view rest = bytes.substr(place - at);
      if (!is_table(file, place, rest)) continue;
      const auto length = load<std::uint64_t>(rest.data() + 8);
      const std::uint64_t there = std::min(length, file.size() - place);
      if (++count <= kMostTold)
        told.push_back(fmt::format("at byte {} ({} of {} bytes, {} streams)", PagedFile::physical(place),
                                   there, length, streams_of(rest.substr(kSectionHeader_bytes))));
      place += (there + 3) / 4 * 4 - 4;
      next = place + 4;
    }
    return false;
  });
  if (count == 0) return "no points are found either";
  return fmt::format(
      "points are there {}{}, but their fields, widths and scales stood in the XML section alone, so that "
      "they "
      "cannot be read",
      fmt::join(told, ", "),
      count > kMostTold ? fmt::format(" and in {} more places", count - kMostTold) : "");
}

}  // namespace hybrid::io
