#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/e57/e57_model.hpp"
#include "io/e57/paged_file.hpp"

namespace hybrid::io {

// Where a table's bytes lie: its data packets in groups of about 256 KiB of the file, each with the bytes of
// every stream that come before it. Found in one pass over the packets' headers, so that any range of records
// of any field can be read alone and groups can be read side by side, whatever the table's size.
struct PacketGroups {
  std::size_t streams = 0;
  std::vector<std::uint64_t> begin{}, end{};  // logical, per group
  std::vector<std::uint64_t> bytes_before{};  // [group * streams + stream]; one more row: the totals

  std::size_t count() const { return begin.size(); }
  std::uint64_t before(std::size_t group, std::size_t stream) const {
    return bytes_before[group * streams + stream];
  }
  std::uint64_t total(std::size_t stream) const { return before(count(), stream); }
};

// Throws ErrorKind::input naming the byte: a section or packet that is none, streams other than the
// prototype's fields, lengths that do not fit, a damaged page. In salvage the groups end before what cannot
// be read, and `notes` say so.
PacketGroups find_packets(const PagedFile& file, const E57Table& table, std::vector<std::string>& notes);

// A data packet's header: its whole length and where its streams lie.
struct PacketHeader {
  enum Type { index = 0, data = 1, ignored = 2 };
  int type = data;
  std::uint32_t length = 0;  // bytes, header included
  std::uint32_t streams = 0;
};
inline constexpr std::uint64_t kPacketHeader_bytes = 6;

// From the first six bytes of a packet.
PacketHeader packet_header(const char* bytes);

}  // namespace hybrid::io
