#include "core/large_vector.hpp"

#include <sys/mman.h>

#include <cstdint>

namespace hybrid {

void prefer_large_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 2 << 20;
  // Whole pages inside the memory alone. A system that refuses goes on with ordinary ones.
  const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace hybrid
