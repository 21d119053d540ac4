#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

#include "core/memory_pause.hpp"

namespace hybrid {

// Limits the host's threads and PoCL's; call before the first device is opened. 0 = all cores.
void set_thread_count(int count);
int thread_count();

// Calls body(i) for i in [0, count), in any order, on the host's threads. Bodies write disjoint memory; sums
// that must not depend on the thread count are formed per fixed block by the body and added in block order
// afterwards.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, std::size_t grain = 1) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    wait_for_memory();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      if (grain == 1) wait_for_memory();
      body(i);
    }
  });
}

}  // namespace hybrid
