#include "compare/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace hybrid::compare {
namespace {

TEST(Median, OfOddEvenAndNone) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({7}), 7);
  EXPECT_THROW(median({}), std::invalid_argument);
}

TEST(Extrapolation, OfOneSizeIsInProportion) {
  EXPECT_DOUBLE_EQ(extrapolate({{1e6, 30}}, 5e6), 150);
}

TEST(Extrapolation, OfTwoSizesFollowsTheirPower) {
  // Time grew as the power 1.5 of the samples.
  EXPECT_NEAR(extrapolate({{1e6, 1}, {4e6, 8}}, 16e6), 64, 1e-9);
}

TEST(Extrapolation, NeverGrowsSlowerThanTheSamplesNorFasterThanTheirSquare) {
  // A start-up cost makes small sizes look cheap to grow from; a cache's edge makes them look steep.
  EXPECT_NEAR(extrapolate({{1e6, 1}, {4e6, 1.1}}, 16e6), 4.4, 1e-9);
  EXPECT_NEAR(extrapolate({{1e6, 1}, {2e6, 100}}, 4e6), 400, 1e-9);
}

TEST(Extrapolation, NeedsASize) {
  EXPECT_THROW(extrapolate({}, 5), std::invalid_argument);
}

TEST(Ratio, SaysHowManyTimesOurs) {
  EXPECT_EQ(ratio_text(6, 2), "3.00 x");
  EXPECT_EQ(ratio_text(1, 4), "0.250 x");
  EXPECT_EQ(ratio_text(1, 0), "-");
}

TEST(ThreeDigits, OfSmallAndLargeValues) {
  EXPECT_EQ(three_digits(0.012345), "0.0123");
  EXPECT_EQ(three_digits(1.2345), "1.23");
  EXPECT_EQ(three_digits(123.45), "123");
  EXPECT_EQ(three_digits(12345.6), "12346");
  EXPECT_EQ(three_digits(0), "0");
  EXPECT_EQ(three_digits(INFINITY), "-");
}

}  // namespace
}  // namespace hybrid::compare
