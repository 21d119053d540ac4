#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/resolve_blend_case.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(ResolveBlend, agrees_with_its_reference_at_every_size_and_in_every_mode) {
  for (std::size_t size : kSizes)
    for (std::uint32_t mode : {BLEND_NEAREST, BLEND_LINEAR, BLEND_BANDS}) {
      auto input = ResolveBlendCase::make(size, 3);
      input.mode = mode;
      const auto got = ResolveBlendCase::run(queue(), input).colour;
      const auto expected = ResolveBlendCase::reference(input).colour;
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(std::isnan(got[i]), std::isnan(expected[i])) << i;
        if (std::isnan(expected[i])) continue;
        ASSERT_NEAR(got[i], expected[i], ResolveBlendCase::kTolerance) << i;
      }
    }
}

TEST(ResolveBlend, agrees_with_its_reference_on_five_bands) {
  const auto input = ResolveBlendCase::make(1009, 3, 5);
  const auto got = ResolveBlendCase::run(queue(), input).colour;
  const auto expected = ResolveBlendCase::reference(input).colour;
  const float tolerance = ResolveBlendCase::kTolerance + 3 * ResolveBlendCase::kTolerancePerBand;
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (!std::isnan(expected[i])) {
      ASSERT_NEAR(got[i], expected[i], tolerance) << i;
    }
}

TEST(ResolveBlend, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return ResolveBlendCase::run(queue(), ResolveBlendCase::make(1009, 3)); });
  EXPECT_TRUE(same_bits(a.colour, b.colour));
}

TEST(ResolveBlend, no_surface_has_no_colour_and_unseen_surface_is_red) {
  auto input = ResolveBlendCase::make(128, 3);
  std::fill(input.seen.begin(), input.seen.end(), 0u);
  std::fill(input.surface_x.begin(), input.surface_x.begin() + 64, std::numeric_limits<float>::quiet_NaN());
  std::fill(input.surface_x.begin() + 64, input.surface_x.end(), 0.0f);
  const auto out = ResolveBlendCase::run(queue(), input).colour;
  for (std::size_t i = 0; i < 128; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      if (i < 64)
        EXPECT_TRUE(std::isnan(out[3 * i + k]));
      else
        EXPECT_EQ(out[3 * i + k], k == 0 ? 1.0f : 0.0f);
    }
}

}  // namespace hybrid::testing
