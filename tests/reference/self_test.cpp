#include <cmath>
#include <limits>

#include "cases/self_test_case.hpp"

namespace hybrid::testing {
namespace {

std::uint32_t murmur3_finaliser(std::uint64_t h) {
  h = ((h ^ (h >> 16)) * 0x85ebca6bu) & 0xffffffffu;
  h = ((h ^ (h >> 13)) * 0xc2b2ae35u) & 0xffffffffu;
  return static_cast<std::uint32_t>(h ^ (h >> 16));
}

}  // namespace

SelfTestCase::Output SelfTestCase::reference(const Input& input) {
  Output out;
  for (std::uint64_t i = 0; i < input.count; ++i) {
    const std::uint32_t inner = murmur3_finaliser((input.seed + 0x9e3779b9u * i) & 0xffffffffu);
    out.bits.push_back(murmur3_finaliser(inner ^ ((0x7f4a7c15u + 0x6c078965u) & 0xffffffffu)));
    const double value = std::sqrt(static_cast<double>(i) + 1) / (1 + static_cast<double>(i % 7));
    out.values.push_back(i % 11 == 10 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value));
  }
  return out;
}

}  // namespace hybrid::testing
