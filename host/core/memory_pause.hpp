#pragma once
#include <atomic>

namespace hybrid {

// Set while a MemoryBudget takes pages out of memory faster than threads may bring in others: parallel_for's
// threads wait between their bodies.
inline std::atomic<bool> memory_is_short = false;

inline void wait_for_memory() {
  if (memory_is_short.load(std::memory_order_relaxed)) memory_is_short.wait(true);
}

}  // namespace hybrid
