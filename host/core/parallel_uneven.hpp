#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <cstddef>

#include "core/memory_pause.hpp"

namespace hybrid {

// parallel_for() for bodies of which a few take most of the time: those come first.
template <typename Body>
void parallel_for_uneven(std::size_t count, const Body& body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          wait_for_memory();
          body(i);
        }
      },
      tbb::simple_partitioner());
}

}  // namespace hybrid
