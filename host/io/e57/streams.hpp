#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "io/e57/e57_model.hpp"
#include "io/e57/packets.hpp"
#include "io/e57/table_reader.hpp"

namespace hybrid::io {

// A part of a stream in memory, as one packet holds it: stream bytes [start, start + length).
struct StreamPart {
  std::uint64_t start = 0;
  const char* bytes = nullptr;
  std::uint64_t length = 0;
  std::uint64_t end() const { return start + length; }
};
using StreamParts = std::vector<StreamPart>;  // ascending, without overlap

// The parts that one group of packets holds of each stream in `fields` (indices), appended to parts[k].
// `bytes` is the group's content; what lies on one of `bad_pages` (ascending) is left out.
void add_parts(const PacketGroups& groups, std::size_t group, const char* bytes,
               std::span<const std::size_t> fields, std::span<const std::uint64_t> bad_pages,
               std::vector<StreamParts>& parts);

// Values [first, first + to.size()) of a field. Values may cross from one part to the next. Those that no
// part holds become 0 and are added to `lost`.
void decode(const E57Field& field, const StreamParts& parts, std::uint64_t first, std::span<std::int64_t> to,
            std::vector<E57Records::Lost>& lost);
void decode(const E57Field& field, const StreamParts& parts, std::uint64_t first, std::span<double> to,
            std::vector<E57Records::Lost>& lost);

}  // namespace hybrid::io
