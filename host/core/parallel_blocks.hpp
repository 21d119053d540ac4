#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/parallel.hpp"

namespace hybrid {

// Calls body(block, begin, end) for the blocks of `size` that make up [0, count), in any order, on the host's
// threads.
template <typename Body>
void for_blocks(std::size_t count, std::size_t size, const Body& body) {
  parallel_for((count + size - 1) / size,
               [&](std::size_t block) { body(block, block * size, std::min((block + 1) * size, count)); });
}

// The sum of what body(begin, end) returns for the blocks of [0, count), added in their order: the same for
// any number of threads. Sum{} is nothing, and += adds.
template <typename Sum, typename Body>
Sum sum_blocks(std::size_t count, const Body& body, std::size_t size = 1 << 18) {
  std::vector<Sum> parts((count + size - 1) / size);
  for_blocks(count, size,
             [&](std::size_t block, std::size_t begin, std::size_t end) { parts[block] = body(begin, end); });
  Sum sum{};
  for (const Sum& part : parts) sum += part;
  return sum;
}

// How many i of [0, count) take(i), called once for each, holds for.
template <typename Take>
std::size_t count_if_parallel(std::size_t count, const Take& take) {
  return sum_blocks<std::size_t>(count, [&](std::size_t begin, std::size_t end) {
    std::size_t taken = 0;
    for (std::size_t i = begin; i < end; ++i) taken += take(i) ? 1 : 0;
    return taken;
  });
}

}  // namespace hybrid
