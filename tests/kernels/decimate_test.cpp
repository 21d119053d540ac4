#include "cases/decimate_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "device.hpp"

namespace hybrid::testing {

TEST(DecimateKernel, equals_its_reference_at_every_size_under_both_rules) {
  for (std::size_t size : kSizes)
    for (std::uint32_t seed : {4u, 5u}) {
      const auto input = DecimateCase::make(size, seed);
      EXPECT_EQ(DecimateCase::run(queue(), input), DecimateCase::reference(input)) << size;
    }
}

TEST(DecimateKernel, empty_nodes_have_no_fate) {
  auto input = DecimateCase::make(1009, 4);
  std::fill(input.mask.begin(), input.mask.end(), std::uint8_t{0});
  for (const std::uint8_t fate : DecimateCase::run(queue(), input)) ASSERT_EQ(fate, FATE_NO_SAMPLE);
}

TEST(DecimateKernel, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return DecimateCase::run(queue(), DecimateCase::make(1009, 4)); });
  EXPECT_TRUE(same_bits(a, b));
}

}  // namespace hybrid::testing
