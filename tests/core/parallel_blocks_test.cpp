#include "core/parallel_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "core/median.hpp"

namespace hybrid {
namespace {

TEST(ParallelBlocks, every_index_is_in_one_block) {
  std::vector<int> visits(1000);
  for_blocks(visits.size(), 64, [&](std::size_t block, std::size_t begin, std::size_t end) {
    EXPECT_EQ(block, begin / 64);
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), std::ssize(visits));
}

TEST(ParallelBlocks, sums_are_added_in_the_blocks_order) {
  // Floats whose sum depends on the order.
  std::vector<float> values(5000);
  std::minstd_rand random(1);
  for (float& v : values) v = std::ldexp(static_cast<float>(random()), static_cast<int>(random() % 40) - 20);
  const auto sum_of = [&](std::size_t begin, std::size_t end) {
    float sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += values[i];
    return sum;
  };
  float wanted = 0;
  for (std::size_t begin = 0; begin < values.size(); begin += 64)
    wanted += sum_of(begin, std::min(begin + 64, values.size()));
  EXPECT_EQ(sum_blocks<float>(values.size(), sum_of, 64), wanted);
  EXPECT_NE(sum_blocks<float>(values.size(), sum_of, values.size()), wanted);
  EXPECT_EQ(sum_blocks<float>(0, sum_of), 0);
}

TEST(ParallelMedian, is_the_one_that_nth_element_finds) {
  std::minstd_rand random(7);
  for (const std::size_t count : {1u, 2u, 3u, 10u, 1001u, 300000u}) {
    for (const float spread : {1e-6f, 1.0f, 1e30f}) {
      std::vector<float> values(count), numbers;
      for (float& v : values) {
        v = spread * (static_cast<float>(random() % 2001) - 1000) / 1000;
        if (random() % 5 == 0) v = std::numeric_limits<float>::quiet_NaN();
      }
      std::copy_if(values.begin(), values.end(), std::back_inserter(numbers), [](float v) { return v == v; });
      const float found = parallel_median(count, [&](std::size_t i) { return values[i]; });
      if (numbers.empty()) {
        EXPECT_EQ(found, 0);
        continue;
      }
      const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
      std::nth_element(numbers.begin(), middle, numbers.end());
      EXPECT_EQ(found, *middle) << count << " values up to " << spread;
    }
  }
}

TEST(ParallelMedian, of_no_number_is_zero) {
  EXPECT_EQ(parallel_median(0, [](std::size_t) { return 1.0f; }), 0);
  EXPECT_EQ(parallel_median(9, [](std::size_t) { return std::numeric_limits<float>::quiet_NaN(); }), 0);
}

TEST(ParallelMedian, infinities_are_numbers_and_negative_zero_is_zero) {
  const std::vector<float> values = {-std::numeric_limits<float>::infinity(), -0.0f,
                                     std::numeric_limits<float>::infinity()};
  const float found = parallel_median(values.size(), [&](std::size_t i) { return values[i]; });
  EXPECT_EQ(found, 0);
  EXPECT_FALSE(std::signbit(found));
  EXPECT_EQ(parallel_median(2, [&](std::size_t i) { return values[i + 1]; }), values[2]);
}

}  // namespace
}  // namespace hybrid
