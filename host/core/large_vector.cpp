#include "core/large_vector.hpp"

#include <sys/mman.h>

#include <atomic>
#include <cstdint>

#include "core/paged_arrays.hpp"
#include "core/parallel_blocks.hpp"

namespace hybrid {

void prefer_large_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 2 << 20, kSmallPage = 4096, kTouched = 2 * kPage;
  // Whole pages inside the memory alone. A system that refuses goes on with ordinary ones.
  const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
  if (begin >= end || paged_arrays::is_ours(memory)) return;
  madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  // Touched rather than populated by request: page faults of several threads run side by side, while requests
  // wait for each other wherever memory is mapped at the same time.
  for_blocks(end - begin, kTouched, [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t at = from; at < to;
         at += kSmallPage)  // a write at once: a page that is read comes twice
      std::atomic_ref(*reinterpret_cast<unsigned char*>(begin + at)).fetch_or(0, std::memory_order_relaxed);
  });
}

}  // namespace hybrid
