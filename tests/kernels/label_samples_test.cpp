#include "cases/label_samples_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "device.hpp"

namespace hybrid::testing {

TEST(LabelSamples, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = LabelSamplesCase::make(size, 11);
    const auto got = LabelSamplesCase::run(queue(), input);
    const auto expected = LabelSamplesCase::reference(input);
    ASSERT_EQ(got.size(), expected.labels.size());
    std::size_t close = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (expected.margin[i] < LabelSamplesCase::kMargin)
        ++close;
      else
        ASSERT_EQ(got[i], expected.labels[i]) << "size " << size << " sample " << i;
    }
    EXPECT_LE(close, got.size() / 20 + 1);
  }
}

TEST(LabelSamples, case_has_winners_and_losers) {
  const auto labels = LabelSamplesCase::reference(LabelSamplesCase::make(1009, 11)).labels;
  const auto none = std::count(labels.begin(), labels.end(), 0u);
  EXPECT_GT(none, 100);
  EXPECT_LT(none, 900);
}

TEST(LabelSamples, labels_nothing_when_all_is_nan) {
  auto input = LabelSamplesCase::make(1009, 11);
  std::fill(input.x.begin(), input.x.end(), std::numeric_limits<float>::quiet_NaN());
  for (const std::uint32_t label : LabelSamplesCase::run(queue(), input)) ASSERT_EQ(label, 0u);
}

TEST(LabelSamples, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] = at_two_work_group_sizes(
      [] { return LabelSamplesCase::run(queue(), LabelSamplesCase::make(1009, 11)); });
  EXPECT_TRUE(same_bits(a, b));
}

}  // namespace hybrid::testing
