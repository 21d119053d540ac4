#pragma once
#include <cstddef>

namespace hybrid::testing {

// The largest single request to operator new, by any thread, while it lives: shows that a reader takes no
// memory on the word of a damaged header. One at a time.
class AllocationWatch {
 public:
  AllocationWatch();
  std::size_t largest_bytes() const;
};

}  // namespace hybrid::testing
