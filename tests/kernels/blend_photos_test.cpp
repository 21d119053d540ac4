#include <gtest/gtest.h>

#include <algorithm>

#include "cases/blend_photos_case.hpp"
#include "device.hpp"

namespace hybrid::testing {
TEST(BlendPhotos, agrees_with_its_reference_at_every_size_and_in_every_mode) {
  for (std::size_t size : kSizes)
    for (const auto& [mode, bands] : kBlendMixes) {
      if (size > 2000 && bands < 4) continue;
      auto input = BlendPhotosCase::make(size, 4);
      input.mix.mode = mode;
      input.mix.bands = bands;
      const auto got = BlendPhotosCase::run(queue(), input);
      const auto expected = BlendPhotosCase::reference(input);
      std::size_t wrong = 0, seen = 0;
      for (std::size_t i = 0; i < input.count(); ++i) {
        wrong += !BlendPhotosCase::agrees(got, expected, i);
        seen += expected.seen[i];
      }
      EXPECT_LE(static_cast<double>(wrong), BlendPhotosCase::kUndecided * static_cast<double>(size)) << size;
      if (size > 100) {
        EXPECT_GT(seen, size / 4);
      }
    }
}

TEST(BlendPhotos, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  auto input = BlendPhotosCase::make(1009, 5);
  input.photos.erase(input.photos.begin(), input.photos.begin() + 2);  // one of each kind
  const auto [a, b] = at_two_work_group_sizes([&] { return BlendPhotosCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a.sums, b.sums));
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.best, b.best);
  for (int width : vector_widths()) {
    input.vector_width = width;
    const auto other = BlendPhotosCase::run(queue(), input);
    EXPECT_TRUE(same_bits(a.sums, other.sums)) << width;
    EXPECT_EQ(a.seen, other.seen) << width;
  }
}

TEST(BlendPhotos, no_surface_gets_no_photograph) {
  auto input = BlendPhotosCase::make(129, 1);
  std::fill(input.surface.begin(), input.surface.end(), std::numeric_limits<float>::quiet_NaN());
  const auto out = BlendPhotosCase::run(queue(), input);
  for (std::size_t i = 0; i < input.count(); ++i) {
    EXPECT_EQ(out.seen[i], 0u);
    EXPECT_EQ(out.best[i], -1);
    EXPECT_EQ(out.sums[BLEND_SUM_WEIGHT * input.count() + i], 0.0f);
  }
}

TEST(BlendPhotos, weights_fall_to_nothing_at_a_photograph_border_and_sum_to_one) {
  // A white photograph: whatever the weights, the weighted mean stays white.
  auto input = BlendPhotosCase::make(1009, 2);
  input.scene = {};
  input.mix.mode = BLEND_LINEAR;
  for (auto& photo : input.photos) std::fill(photo.pixels.begin(), photo.pixels.end(), std::uint8_t{255});
  const auto out = BlendPhotosCase::run(queue(), input);
  input.feather_px = 0;
  const auto unfeathered = BlendPhotosCase::run(queue(), input);
  std::size_t lighter = 0;
  for (std::size_t i = 0; i < input.count(); ++i) {
    EXPECT_EQ(out.seen[i], unfeathered.seen[i]);
    const float weight = out.sums[BLEND_SUM_WEIGHT * input.count() + i];
    EXPECT_LE(weight, unfeathered.sums[BLEND_SUM_WEIGHT * input.count() + i]);
    lighter += weight < unfeathered.sums[BLEND_SUM_WEIGHT * input.count() + i];
    if (out.seen[i]) {
      EXPECT_NEAR(out.sums[BLEND_SUM_G * input.count() + i] / weight, 1, 1e-5);
    }
  }
  EXPECT_GT(lighter, 50u);
}

}  // namespace hybrid::testing
