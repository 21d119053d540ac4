#pragma once
#include <cstdint>
#include <vector>

#include "device/queue.hpp"

namespace hybrid::testing {

// One description per kernel, shared by its test (kernels/), its double-precision twin (reference/) and its
// bench.
struct SelfTestCase {
  static constexpr const char* kName = "self_test";
  struct Input {
    std::uint32_t count, seed;
  };
  struct Output {
    std::vector<std::uint32_t> bits;
    std::vector<float> values;
  };

  static Input make(std::size_t size, std::uint32_t seed) { return {static_cast<std::uint32_t>(size), seed}; }
  static Output run(device::Queue& queue, const Input& input) {
    auto bits = queue.array<std::uint32_t>(input.count);
    auto values = queue.array<float>(input.count);
    queue.launch(kName, queue.kernel(kName), device::grid(input.count), input.seed, input.count, bits,
                 values);
    return {queue.read(bits), queue.read(values)};
  }
  static Output reference(const Input& input);  // reference/self_test.cpp

  static double items(const Input& input) { return input.count; }
  static double bytes(const Input& input) { return 8.0 * input.count; }
  static double flops(const Input& input) { return 4.0 * input.count; }
};

}  // namespace hybrid::testing
