#pragma once
#include <cstddef>
#include <vector>

namespace hybrid {

// Asks the system for large pages for this memory, where it gives them on request: touching ordinary ones one
// by one for the first time costs more than filling them. `operator new` does for every large array, see
// new_arrays.cpp.
void ask_for_large_pages(void* memory, std::size_t bytes) noexcept;

// Touches all pages at once, on all threads; changes nothing else. Arrays under a MemoryBudget are left
// alone: their pages come as they are filled, no faster than others can go.
void touch_pages(void* memory, std::size_t bytes);

// values.assign(count, value) on pages touched so.
template <typename T>
void assign_large(std::vector<T>& values, std::size_t count, const T& value) {
  values.reserve(count);
  touch_pages(values.data(), count * sizeof(T));
  values.assign(count, value);
}

// values.resize(count) of an empty vector likewise.
template <typename T>
void resize_large(std::vector<T>& values, std::size_t count) {
  assign_large(values, count, T{});
}

}  // namespace hybrid
