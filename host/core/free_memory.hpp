#pragma once
#include <vector>

namespace hybrid {

// Gives a vector's memory back. `values = {}` does not: that assigns an empty list and keeps the capacity.
template <typename T>
void free_memory(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

}  // namespace hybrid
