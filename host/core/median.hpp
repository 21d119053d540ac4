#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel_blocks.hpp"

namespace hybrid {

// Of n values the one that n / 2 are before in ascending order, NaN of none; reorders them.
inline double median(std::vector<double>& values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The median of those of value(i), i in [0, count), that are numbers (NaN: none): of n the one that n / 2 are
// before in ascending order; 0 when there are none. On all threads, from three counts of eleven bits, the
// highest first: nothing is copied, value() is called three times for each i.
template <typename Value>
float parallel_median(std::size_t count, const Value& value) {
  constexpr unsigned kBits = 11, kBuckets = 1 << kBits;
  struct Counts : std::array<std::size_t, kBuckets> {
    Counts() : std::array<std::size_t, kBuckets>{} {}
    Counts& operator+=(const Counts& other) {
      for (unsigned k = 0; k < kBuckets; ++k) (*this)[k] += other[k];
      return *this;
    }
  };
  // Ascending with the number; 0 and -0 are one.
  const auto key = [](float v) {
    const auto bits = std::bit_cast<std::uint32_t>(v + 0.0f);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
  };
  std::uint32_t found = 0;  // its upper bits
  std::size_t rank = 0;
  for (const unsigned shift : {21u, 10u, 0u}) {
    const unsigned bits = shift == 0 ? 10 : kBits;
    const bool all = shift == 21;
    const Counts counts = sum_blocks<Counts>(count, [&](std::size_t begin, std::size_t end) {
      Counts own;
      for (std::size_t i = begin; i < end; ++i) {
        const float v = value(i);
        if (std::isnan(v)) continue;
        const std::uint32_t k = key(v);
        if (all || k >> (shift + bits) == found) ++own[(k >> shift) & ((1u << bits) - 1)];
      }
      return own;
    });
    if (all) {
      for (const std::size_t n : counts) rank += n;
      if (rank == 0) return 0;
      rank /= 2;
    }
    std::uint32_t bucket = 0;
    while (rank >= counts[bucket]) rank -= counts[bucket++];
    found = found << bits | bucket;
  }
  return std::bit_cast<float>(found >> 31 ? found & 0x7fffffffu : ~found);
}

}  // namespace hybrid
