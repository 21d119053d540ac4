#include "core/free_memory.hpp"

#include <malloc.h>

namespace hybrid {

void give_back_free_memory() {
  constexpr std::size_t kLeast_bytes = 64 << 20;
  if (mallinfo2().fordblks >= kLeast_bytes) malloc_trim(0);
}

}  // namespace hybrid
