#pragma once
#include <cstdlib>
#include <cstring>
#include <vector>

#include "device/queue.hpp"

namespace hybrid::testing {

// The queue all tests of one process share: kernels build once. Its device: as HYBRID_TEST_DEVICE says.
device::Queue& queue();

// Where every memory access is checked (tests/oclgrind.sh).
inline bool small_sizes() {
  return std::getenv("HYBRID_SMALL_SIZES") != nullptr;
}

// Sizes every kernel is tried at (STYLE.md): none, one, a work-group +-1, a prime, large. Under oclgrind,
// which checks every memory access, the test runner asks for the small ones (HYBRID_SMALL_SIZES).
inline const std::vector<std::size_t> kSizes =
    small_sizes() ? std::vector<std::size_t>{0, 1, 127, 129}
                  : std::vector<std::size_t>{0, 1, 127, 128, 129, 1009, 100003};

// Lanes that kernels on explicit vectors are tried at: those that some CPU has; one elsewhere.
inline std::vector<int> vector_widths() {
  return queue().device().is_cpu ? std::vector<int>{1, 4, 8, 16} : std::vector<int>{1};
}

// Bit-for-bit equality, so that NaN equals NaN and -0 differs from 0.
template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Runs `body` at work-group sizes 16 and 64 and returns both results.
template <typename Body>
auto at_two_work_group_sizes(const Body& body) {
  queue().set_work_group_size(16);
  auto first = body();
  queue().set_work_group_size(64);
  auto second = body();
  queue().set_work_group_size(0);
  return std::pair(std::move(first), std::move(second));
}

}  // namespace hybrid::testing
