#include "io/e57/packets.hpp"

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "io/e57/little_endian.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kSectionHeader_bytes = 32;
constexpr std::uint64_t kGroup_bytes = 256 << 10;
constexpr std::uint64_t kAhead_bytes = 4 * PagedFile::kPayload_bytes;

// Small reads in ascending order, some pages at a time.
class HeaderWindow {
 public:
  explicit HeaderWindow(const PagedFile& file) : file_(file) {}
  const char* at(std::uint64_t offset, std::uint64_t bytes) {
    if (offset < start_ || offset + bytes > start_ + window_.size()) {
      // To the end of a page, so that none is read twice.
      const std::uint64_t first = offset / PagedFile::kPayload_bytes * PagedFile::kPayload_bytes;
      const std::uint64_t wanted = std::max(offset + bytes - first, kAhead_bytes);
      std::uint64_t end = first + (wanted + PagedFile::kPayload_bytes - 1) / PagedFile::kPayload_bytes *
                                      PagedFile::kPayload_bytes;
      window_.resize(std::min(end, std::max(file_.size(), offset + bytes)) - first);
      start_ = first;
      file_.read(first, window_);
    }
    return window_.data() + (offset - start_);
  }

 private:
  const PagedFile& file_;
  std::uint64_t start_ = 0;
  std::vector<char> window_;
};

struct Section {
  std::uint64_t data = 0, end = 0;  // logical
};

Section read_section_header(const PagedFile& file, const E57Table& table) {
  const std::uint64_t start = file.logical(table.offset, table.what + ": its points");
  std::array<char, kSectionHeader_bytes> header{};
  file.read(start, header);
  const auto where = fmt::format("{}: byte {}: {}", file.name(), table.offset, table.what);
  if (header[0] != 1)
    fail_input("{}: expected a section of points (1), found {}; export the file again", where,
               static_cast<int>(static_cast<unsigned char>(header[0])));
  const auto length = load<std::uint64_t>(&header[8]), data = load<std::uint64_t>(&header[16]);
  if (length < kSectionHeader_bytes || length > file.size() - start)
    fail_input("{}: expected a section of {} to {} bytes, found {}; the file is cut short: copy it again",
               where, kSectionHeader_bytes, file.size() - start, length);
  Section section{start + length, start + length};
  if (table.count == 0 && data == 0) return section;
  section.data = file.logical(data, table.what + ": its first packet");
  if (section.data < start + kSectionHeader_bytes || section.data > section.end)
    fail_input(
        "{}: expected the first packet within the section's {} bytes, found it at byte {}; export the file "
        "again",
        where, length, data);
  return section;
}

}  // namespace

PacketHeader packet_header(const char* bytes) {
  return {static_cast<unsigned char>(bytes[0]), load<std::uint16_t>(bytes + 2) + 1u,
          load<std::uint16_t>(bytes + 4)};
}

PacketGroups find_packets(const PagedFile& file, const E57Table& table, std::vector<std::string>&) {
  const Section section = read_section_header(file, table);
  PacketGroups groups{.streams = table.fields.size()};
  std::vector<std::uint64_t> sums(groups.streams, 0);
  HeaderWindow window(file);
  bool open = false;  // the last group takes further packets
  for (std::uint64_t at = section.data; at < section.end;) {
    const auto where = [&] {
      return fmt::format("{}: byte {}: {}", file.name(), PagedFile::physical(at), table.what);
    };
    if (section.end - at < kPacketHeader_bytes - 2)
      fail_input("{}: expected a packet, found the {} last bytes of the section; export the file again",
                 where(), section.end - at);
    // A packet of four bytes has no stream count.
    const std::uint64_t least = std::min(kPacketHeader_bytes, section.end - at);
    std::array<char, kPacketHeader_bytes> start{};
    std::copy_n(window.at(at, least), least, start.data());
    const PacketHeader header = packet_header(start.data());
    if (header.type > PacketHeader::ignored || header.length % 4 != 0 || header.length > section.end - at)
      fail_input(
          "{}: expected a packet (type 0 to 2, at most {} bytes in fours), found type {} with {} bytes; "
          "export the file again",
          where(), section.end - at, header.type, header.length);
    if (header.type != PacketHeader::data) {
      open = false;
      at += header.length;
      continue;
    }
    const std::uint64_t lengths = kPacketHeader_bytes + 2ull * header.streams;
    // Writers close a section without points by a packet without streams.
    if (header.streams != groups.streams && !(header.streams == 0 && table.count == 0))
      fail_input(
          "{}: expected a packet of {} streams as the prototype has fields, found {}; export the file again",
          where(), groups.streams, header.streams);
    if (lengths > header.length)
      fail_input("{}: expected a packet of at least {} bytes, found {}; export the file again", where(),
                 lengths, header.length);
    if (!open) {
      groups.begin.push_back(at);
      groups.end.push_back(at);
      groups.bytes_before.insert(groups.bytes_before.end(), sums.begin(), sums.end());
    }
    const char* length = window.at(at, lengths) + kPacketHeader_bytes;
    std::uint64_t needed = lengths;
    for (std::size_t s = 0; s < header.streams; ++s) {
      const auto bytes = load<std::uint16_t>(length + 2 * s);
      needed += bytes;
      sums[s] += bytes;
    }
    if (needed > header.length || header.length - needed > 3)
      fail_input("{}: expected a packet of {} bytes for its streams, found {}; export the file again",
                 where(), (needed + 3) / 4 * 4, header.length);
    at += header.length;
    groups.end.back() = at;
    open = at - groups.begin.back() < kGroup_bytes;
  }
  groups.bytes_before.insert(groups.bytes_before.end(), sums.begin(), sums.end());
  return groups;
}

}  // namespace hybrid::io
