#pragma once
#include <cstdint>
#include <cstring>

namespace hybrid::io {

// Numbers as E57 stores them; the machines we run on have the same byte order.
template <typename T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

template <typename T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

}  // namespace hybrid::io
