#include "device/self_test.hpp"

#include <cmath>

#include "lib/random.h"

namespace hybrid::device {

std::string self_test(Queue& queue) {
  const std::uint32_t count = 100003, seed = 7;
  auto bits = queue.array<std::uint32_t>(count);
  auto values = queue.array<float>(count);
  queue.launch("self_test", queue.kernel("self_test"), grid(count), seed, count, bits, values);
  const auto got_bits = queue.read(bits);
  const auto got_values = queue.read(values);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (got_bits[i] != random_bits(seed, i, 1))
      return fmt::format("integers: item {}: expected {}, found {}", i, random_bits(seed, i, 1), got_bits[i]);
    const float expected = std::sqrt(static_cast<float>(i + 1)) / (1.0f + static_cast<float>(i % 7));
    const bool same = i % 11 == 10 ? std::isnan(got_values[i]) : got_values[i] == expected;
    if (!same) return fmt::format("floats: item {}: expected {}, found {}", i, expected, got_values[i]);
  }
  return "";
}

}  // namespace hybrid::device
