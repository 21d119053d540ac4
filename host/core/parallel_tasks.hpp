#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "core/parallel.hpp"

namespace hybrid {

// Runs different tasks on the host's threads, begun in their order. The long ones of one thread belong before
// those that share all threads, so that none of them is left alone at the end.
inline void run_tasks(const std::vector<std::function<void()>>& tasks) {
  std::atomic<std::size_t> next = 0;
  parallel_for(tasks.size(), [&](std::size_t) { tasks[next++](); });
}

}  // namespace hybrid
