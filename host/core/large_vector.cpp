#include "core/large_vector.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>

#include "core/parallel.hpp"

namespace hybrid {

void prefer_large_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 2 << 20;
  // Whole pages inside the memory alone. A system that refuses goes on with ordinary ones.
  const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
  if (begin >= end) return;
  madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#ifdef MADV_POPULATE_WRITE
  constexpr std::uintptr_t kPiece = 16 * kPage;
  parallel_for((end - begin + kPiece - 1) / kPiece, [&](std::size_t i) {
    const std::uintptr_t from = begin + i * kPiece;
    madvise(reinterpret_cast<void*>(from), std::min(kPiece, end - from), MADV_POPULATE_WRITE);
  });
#endif
}

}  // namespace hybrid
