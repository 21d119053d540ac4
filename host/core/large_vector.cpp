#include "core/large_vector.hpp"

#include <sys/mman.h>

#include <atomic>
#include <cstdint>
#include <utility>

#include "core/paged_arrays.hpp"
#include "core/parallel_blocks.hpp"

namespace hybrid {
namespace {

constexpr std::uintptr_t kPage = 2 << 20;

// The whole pages inside the memory alone, from where to where.
std::pair<std::uintptr_t, std::uintptr_t> pages_of(const void* memory, std::size_t bytes) {
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  return {(begin + kPage - 1) / kPage * kPage, (begin + bytes) / kPage * kPage};
}

}  // namespace

void ask_for_large_pages(void* memory, std::size_t bytes) noexcept {
  const auto [begin, end] = pages_of(memory, bytes);
  // A system that refuses goes on with ordinary ones.
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

void touch_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kSmallPage = 4096, kTouched = 2 * kPage;
  const auto [begin, end] = pages_of(memory, bytes);
  if (begin >= end || paged_arrays::is_ours(memory)) return;
  // Touched rather than populated by request: page faults of several threads run side by side, while requests
  // wait for each other wherever memory is mapped at the same time.
  for_blocks(end - begin, kTouched, [first = begin](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t at = from; at < to;
         at += kSmallPage)  // a write at once: a page that is read comes twice
      std::atomic_ref(*reinterpret_cast<unsigned char*>(first + at)).fetch_or(0, std::memory_order_relaxed);
  });
}

}  // namespace hybrid
