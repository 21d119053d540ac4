#include "io/e57/streams.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "io/e57/bit_decoder.hpp"
#include "io/e57/little_endian.hpp"

namespace hybrid::io {
namespace {

// `part`, which lies at logical offset `at` of the file, without what lies on bad pages.
void add_good(StreamPart part, std::uint64_t at, std::span<const std::uint64_t> bad_pages, StreamParts& to) {
  if (part.length == 0) return;
  for (const std::uint64_t page : bad_pages) {
    const std::uint64_t begin = page * PagedFile::kPayload_bytes, end = begin + PagedFile::kPayload_bytes;
    if (end <= at || begin >= at + part.length) continue;
    if (begin > at) to.push_back({part.start, part.bytes, begin - at});
    const std::uint64_t skipped = std::min(end - at, part.length);
    part = {part.start + skipped, part.bytes + skipped, part.length - skipped};
    at += skipped;
  }
  if (part.length > 0) to.push_back(part);
}

// Stream bytes [from, end) from wherever they are; false when some are nowhere.
bool gather(const StreamParts& parts, StreamParts::const_iterator part, std::uint64_t from, std::uint64_t end,
            char* to) {
  for (; from < end; ++part) {
    if (part == parts.end() || part->start > from || part->end() <= from) return false;
    const std::uint64_t count = std::min(end, part->end()) - from;
    std::memcpy(to, part->bytes + (from - part->start), count);
    to += count;
    from += count;
  }
  return true;
}

// unpack(bytes, first bit, destination) for runs of whole values.
template <typename T, typename Unpack>
void decode_runs(std::uint64_t width, const StreamParts& parts, std::uint64_t first, std::span<T> to,
                 std::vector<E57Records::Lost>& lost, const Unpack& unpack) {
  const std::uint64_t end = first + to.size();
  const auto rest = [&](std::uint64_t value, std::uint64_t count) {
    return to.subspan(value - first, count);
  };
  auto part = parts.begin();
  if (!parts.empty()) {
    part = std::upper_bound(parts.begin(), parts.end(), first * width / 8,
                            [](std::uint64_t byte, const StreamPart& p) { return byte < p.start; });
    if (part != parts.begin()) --part;
  }
  for (std::uint64_t value = first; value < end;) {
    const std::uint64_t byte = value * width / 8;
    while (part != parts.end() && part->end() <= byte) ++part;
    if (part != parts.end() && part->start <= byte) {
      const std::uint64_t whole = std::min(end, part->end() * 8 / width);
      if (whole > value) {
        unpack(part->bytes, value * width - part->start * 8, rest(value, whole - value));
        value = whole;
        continue;
      }
      std::array<char, 9 + kBitSlack_bytes> bytes{};
      if (gather(parts, part, byte, ((value + 1) * width + 7) / 8, bytes.data())) {
        unpack(bytes.data(), value * width % 8, rest(value, 1));
        ++value;
        continue;
      }
      ++part;
    }
    const std::uint64_t next =
        part == parts.end() ? end : std::min(end, std::max(value + 1, (part->start * 8 + width - 1) / width));
    std::ranges::fill(rest(value, next - value), T{});
    lost.push_back({value, next});
    value = next;
  }
}

}  // namespace

void add_parts(const PacketGroups& groups, std::size_t group, const char* bytes,
               std::span<const std::size_t> fields, std::span<const std::uint64_t> bad_pages,
               std::vector<StreamParts>& parts) {
  std::vector<std::uint64_t> start(groups.streams);
  for (std::size_t s = 0; s < groups.streams; ++s) start[s] = groups.before(group, s);
  const std::uint64_t begin = groups.begin[group];
  const std::uint64_t end = groups.end[group];
  std::vector<std::uint32_t> offset(groups.streams);
  for (std::uint64_t at = begin; at < end;) {
    const char* packet = bytes + (at - begin);
    const PacketHeader header = packet_header(packet);
    if (header.streams == groups.streams) {
      std::uint32_t next = static_cast<std::uint32_t>(kPacketHeader_bytes) + 2 * header.streams;
      for (std::size_t s = 0; s < groups.streams; ++s) {
        offset[s] = next;
        next += load<std::uint16_t>(packet + kPacketHeader_bytes + 2 * s);
      }
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const std::size_t s = fields[k];
        const auto length = load<std::uint16_t>(packet + kPacketHeader_bytes + 2 * s);
        add_good({start[s], packet + offset[s], length}, at + offset[s], bad_pages, parts[k]);
        start[s] += length;
      }
    }
    at += header.length;
  }
}

void decode(const E57Field& field, const StreamParts& parts, std::uint64_t first, std::span<std::int64_t> to,
            std::vector<E57Records::Lost>& lost) {
  const int width = field.bits();
  if (width == 0) {
    std::ranges::fill(to, field.minimum);
    return;
  }
  decode_runs(static_cast<std::uint64_t>(width), parts, first, to, lost,
              [&](const char* bytes, std::uint64_t bit, std::span<std::int64_t> values) {
                unpack_bits(bytes, bit, width, field.minimum, values);
              });
}

void decode(const E57Field& field, const StreamParts& parts, std::uint64_t first, std::span<double> to,
            std::vector<E57Records::Lost>& lost) {
  const bool single = field.type == E57Type::single_real;
  decode_runs(single ? 32 : 64, parts, first, to, lost,
              [&](const char* bytes, std::uint64_t bit, std::span<double> values) {
                const char* at = bytes + bit / 8;
                if (single)
                  for (std::size_t i = 0; i < values.size(); ++i)
                    values[i] = static_cast<double>(load<float>(at + 4 * i));
                else
                  std::memcpy(values.data(), at, values.size_bytes());
              });
}

}  // namespace hybrid::io
