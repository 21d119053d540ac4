// The program's `operator new` and `delete`: malloc, but large arrays come in large pages, and under a memory
// budget in files. Any program that uses the core library has these in place of the standard library's, which
// do the same without either.
#include <cstdlib>
#include <new>

#include "core/large_vector.hpp"
#include "core/paged_arrays.hpp"

void* operator new(std::size_t bytes) {
  if (bytes >= hybrid::paged_arrays::kLeast_bytes)
    if (void* array = hybrid::paged_arrays::make(bytes)) return array;
  while (true) {
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) {
      if (bytes >= hybrid::paged_arrays::kLeast_bytes) hybrid::ask_for_large_pages(memory, bytes);
      return memory;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void* operator new[](std::size_t bytes) {
  return operator new(bytes);
}

void operator delete(void* memory) noexcept {
  if (hybrid::paged_arrays::is_ours(memory))
    hybrid::paged_arrays::release(memory);
  else
    std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  operator delete(memory);
}
