#include "cases/self_test_case.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "device.hpp"
#include "device/self_test.hpp"

namespace hybrid::testing {

TEST(SelfTest, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = SelfTestCase::make(size, 3);
    const auto got = SelfTestCase::run(queue(), input);
    const auto expected = SelfTestCase::reference(input);
    EXPECT_EQ(got.bits, expected.bits);
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_EQ(std::isnan(got.values[i]), std::isnan(expected.values[i])) << i;
      // One rounding of the root and one of the division: at most 1.5 units in the last place.
      if (std::isnan(got.values[i])) continue;
      ASSERT_NEAR(got.values[i], expected.values[i], 2e-7 * expected.values[i]) << i;
    }
  }
}

TEST(SelfTest, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return SelfTestCase::run(queue(), SelfTestCase::make(1009, 3)); });
  EXPECT_TRUE(same_bits(a.bits, b.bits));
  EXPECT_TRUE(same_bits(a.values, b.values));
}

TEST(SelfTest, known_answers_hold_on_this_device) {
  EXPECT_EQ(device::self_test(queue()), "");
}

}  // namespace hybrid::testing
