#pragma once
#include <sys/mman.h>

#include <cstdint>
#include <vector>

namespace hybrid::io {

// Resizes an empty vector, asking the system for large pages first where it has them: of the time to decode a
// scan, a good part went to the faults of small ones.
template <typename T>
void resize_in_large_pages(std::vector<T>& values, std::size_t count) {
  constexpr std::uintptr_t kLargePage_bytes = 2 << 20;
  values.reserve(count);
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + kLargePage_bytes - 1) /
                     kLargePage_bytes * kLargePage_bytes;
  const auto end = (reinterpret_cast<std::uintptr_t>(values.data()) + count * sizeof(T)) / kLargePage_bytes *
                   kLargePage_bytes;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  values.resize(count);
}

}  // namespace hybrid::io
