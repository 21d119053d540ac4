#pragma once
#include <vector>

namespace hybrid {

// Gives a vector's memory back. `values = {}` does not: that assigns an empty list and keeps the capacity.
template <typename T>
void free_memory(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

// Gives pages that malloc holds free, between what is in use, to the system, where they are many: after the
// stages of a large scan they are an eighth of all, and what follows needs others.
void give_back_free_memory();

}  // namespace hybrid
