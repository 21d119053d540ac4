#include "geometry/colour.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace hybrid::testing {

TEST(SrgbByte, is_what_the_formula_gives) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto formula = [](double linear) { return std::lround(255 * srgb_from_linear(linear)); };
  for (int i = 0; i < 200'000; ++i) {
    const double linear = i % 2 ? unit(random) : std::pow(unit(random), 3);  // dark ones, too
    ASSERT_EQ(srgb_byte_from_linear(linear), formula(linear)) << linear;
  }
  // On either side of where a byte begins.
  for (int byte = 1; byte < 256; ++byte) {
    const double begin = linear_from_srgb((byte - 0.5) / 255);
    EXPECT_EQ(srgb_byte_from_linear(begin - 1e-12), byte - 1);
    EXPECT_EQ(srgb_byte_from_linear(begin + 1e-12), byte);
  }
}

TEST(SrgbByte, clamps_and_knows_no_colour_of_no_number) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double dark : {0.0, -1.0, -infinity, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(srgb_byte_from_linear(dark), 0);
  for (const double bright : {1.0, 1.5, infinity}) EXPECT_EQ(srgb_byte_from_linear(bright), 255);
}

}  // namespace hybrid::testing
