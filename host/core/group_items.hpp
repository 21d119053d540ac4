#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel_blocks.hpp"

namespace hybrid {

inline constexpr std::uint32_t kNoGroup = ~std::uint32_t{0};

// Values by group: those of group g are values[begin[g]] .. values[begin[g + 1]).
struct ItemGroups {
  std::vector<std::uint32_t> values;
  std::vector<std::size_t> begin;  // one more than groups
};

// value_of(i) of all i of [0, count), fewer than 2^32, by group_of(i): below `groups`, or kNoGroup for those
// left out. The order of i stays within a group. A counting sort on the host's threads, which calls group_of
// twice for each i.
template <typename GroupOf, typename ValueOf>
ItemGroups group_items(std::size_t count, std::size_t groups, const GroupOf& group_of,
                       const ValueOf& value_of) {
  constexpr std::size_t kMostBlocks = 64, kLeastInBlock = 1 << 16;
  const std::size_t size = std::max(kLeastInBlock, (count + kMostBlocks - 1) / kMostBlocks);
  std::vector<std::vector<std::uint32_t>> next((count + size - 1) / size);  // per block and group
  for_blocks(count, size, [&](std::size_t block, std::size_t begin, std::size_t end) {
    next[block].assign(groups, 0);
    for (std::size_t i = begin; i < end; ++i)
      if (const std::uint32_t group = group_of(i); group != kNoGroup) ++next[block][group];
  });
  ItemGroups result;
  result.begin.reserve(groups + 1);
  std::uint32_t total = 0;
  for (std::size_t group = 0; group < groups; ++group) {
    result.begin.push_back(total);
    for (auto& of_block : next) {
      const std::uint32_t in_block = of_block[group];
      of_block[group] = total;
      total += in_block;
    }
  }
  result.begin.push_back(total);
  result.values.resize(total);
  for_blocks(count, size, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (const std::uint32_t group = group_of(i); group != kNoGroup)
        result.values[next[block][group]++] = value_of(i);
  });
  return result;
}

}  // namespace hybrid
