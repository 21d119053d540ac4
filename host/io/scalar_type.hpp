#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

namespace hybrid::io {

// The number types of binary PLY and PCD records.
enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

inline std::size_t size_of(ScalarType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

inline bool is_real(ScalarType type) {
  return type == ScalarType::f32 || type == ScalarType::f64;
}

template <typename T>
T load_as(const char* at, bool swap_bytes) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, at, sizeof(T));
  if (swap_bytes) std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// The number at `at` (any alignment). Integers beyond 2^53 are rounded: no field that is used holds them.
inline double load_scalar(const char* at, ScalarType type, bool swap_bytes) {
  switch (type) {
    case ScalarType::i8:
      return load_as<std::int8_t>(at, false);
    case ScalarType::u8:
      return load_as<std::uint8_t>(at, false);
    case ScalarType::i16:
      return load_as<std::int16_t>(at, swap_bytes);
    case ScalarType::u16:
      return load_as<std::uint16_t>(at, swap_bytes);
    case ScalarType::i32:
      return load_as<std::int32_t>(at, swap_bytes);
    case ScalarType::u32:
      return load_as<std::uint32_t>(at, swap_bytes);
    case ScalarType::i64:
      return static_cast<double>(load_as<std::int64_t>(at, swap_bytes));
    case ScalarType::u64:
      return static_cast<double>(load_as<std::uint64_t>(at, swap_bytes));
    case ScalarType::f32:
      return static_cast<double>(load_as<float>(at, swap_bytes));
    case ScalarType::f64:
      return load_as<double>(at, swap_bytes);
  }
  return 0;
}

}  // namespace hybrid::io
