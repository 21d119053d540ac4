#include "cases/square_links_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "device.hpp"

namespace hybrid::testing {

TEST(SquareLinks, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    for (std::uint32_t wraps : {0u, 1u}) {
      auto input = SquareLinksCase::make(size, 5);
      input.params.wraps = wraps;
      const auto got = SquareLinksCase::run(queue(), input);
      const auto expected = SquareLinksCase::reference(input);
      ASSERT_EQ(got.size(), expected.links.size());
      for (std::size_t i = 0; i < got.size(); ++i) {
        if (expected.margin[i] < SquareLinksCase::kMargin) continue;
        ASSERT_NEAR(got[i], expected.links[i], SquareLinksCase::kTolerance)
            << "size " << size << " link " << i;
      }
    }
  }
}

TEST(SquareLinks, case_meets_links_and_breaks_of_every_kind) {
  const auto expected = SquareLinksCase::reference(SquareLinksCase::make(1009, 5));
  const auto linked =
      std::count_if(expected.links.begin(), expected.links.end(), [](double c) { return c >= 0; });
  EXPECT_GT(linked, 200);
  EXPECT_LT(linked, 1500);
}

TEST(SquareLinks, links_nothing_when_all_is_nan) {
  auto input = SquareLinksCase::make(1009, 5);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (auto& square : input.squares)
    for (int k = 0; k < 3; ++k) square.normal[k] = square.centroid[k] = nan;
  for (const float link : SquareLinksCase::run(queue(), input)) ASSERT_EQ(link, -1.0f);
}

TEST(SquareLinks, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return SquareLinksCase::run(queue(), SquareLinksCase::make(1009, 5)); });
  EXPECT_TRUE(same_bits(a, b));
}

}  // namespace hybrid::testing
