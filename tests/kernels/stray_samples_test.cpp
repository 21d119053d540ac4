#include "cases/stray_samples_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "device.hpp"

namespace hybrid::testing {

TEST(StraySamples, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = StraySamplesCase::make(size, 11);
    const auto got = StraySamplesCase::run(queue(), input);
    const auto expected = StraySamplesCase::reference(input);
    ASSERT_EQ(got.size(), expected.size());
    std::size_t undecided = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_TRUE(expected[i] >> got[i] & 1) << "size " << size << " sample " << i;
      undecided += (expected[i] & (expected[i] - 1)) != 0;
    }
    EXPECT_LE(undecided, got.size() / 100 + 1);
  }
}

TEST(StraySamples, case_meets_every_answer) {
  const auto stray = StraySamplesCase::run(queue(), StraySamplesCase::make(1009, 11));
  for (const int answer : {STRAY_NONE, STRAY_BETWEEN, STRAY_ISOLATED})
    EXPECT_GT(std::count(stray.begin(), stray.end(), answer), 5) << answer;
}

TEST(StraySamples, nothing_measured_is_nothing_stray) {
  auto input = StraySamplesCase::make(1009, 11);
  for (auto* values : {&input.x, &input.y, &input.z})
    std::fill(values->begin(), values->end(), std::numeric_limits<float>::quiet_NaN());
  for (const std::uint8_t answer : StraySamplesCase::run(queue(), input)) ASSERT_EQ(answer, STRAY_NONE);
}

TEST(StraySamples, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  auto input = StraySamplesCase::make(1009, 11);
  const auto [a, b] = at_two_work_group_sizes([&] { return StraySamplesCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a, b));
  for (const int width : vector_widths()) {
    input.vector_width = width;
    EXPECT_TRUE(same_bits(StraySamplesCase::run(queue(), input), a)) << width;
  }
}

}  // namespace hybrid::testing
