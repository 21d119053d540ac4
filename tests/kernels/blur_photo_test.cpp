#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "cases/blur_photo_case.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(BlurPhoto, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = BlurPhotoCase::make(size, 3);
    const auto got = BlurPhotoCase::run(queue(), input).low;
    const auto expected = BlurPhotoCase::reference(input).low;
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i)
      ASSERT_NEAR(got[i], expected[i], BlurPhotoCase::kTolerance) << i;
  }
}

TEST(BlurPhoto, a_wide_gaussian_goes_where_it_is_told_to) {
  auto input = BlurPhotoCase::make(60 * 60, 3, 16);  // reaches over several strips and beyond the border
  input.first = 1000;
  const auto got = BlurPhotoCase::run(queue(), input).low;
  const auto expected = BlurPhotoCase::reference(input).low;
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    ASSERT_NEAR(got[i], expected[i], BlurPhotoCase::kTolerance) << i;
}

// Every seventh pixel and a block are masked; the row goes on at the other side.
TEST(BlurPhoto, masked_pixels_are_no_taps_and_a_panorama_has_no_sides) {
  auto input = BlurPhotoCase::make(36 * 36, 3);
  input.flags = CAMERA_WRAPS | CAMERA_HAS_MASK;
  for (std::size_t i = 0; i < input.count(); ++i) {
    const std::size_t x = i % 36, y = i / 36;
    input.pixels[4 * i + 3] = i % 7 == 0 || (x < 25 && y < 25) ? 0 : 255;
    input.id[i] = 5;  // one surface
  }
  const auto got = BlurPhotoCase::run(queue(), input).low;
  const auto expected = BlurPhotoCase::reference(input).low;
  std::size_t nothing = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_NEAR(got[i], expected[i], BlurPhotoCase::kTolerance) << i;
    nothing += got[i] == 0;
  }
  EXPECT_GT(nothing, 4u);  // in the midst of the block
  input.flags = CAMERA_HAS_MASK;
  const auto cut = BlurPhotoCase::run(queue(), input).low;
  const auto row = [](const auto& low, std::size_t x) { return low[4 * (30 * 36 + x)]; };
  EXPECT_EQ(row(cut, 18), row(got, 18));
  EXPECT_NE(row(cut, 0), row(got, 0));
  EXPECT_NE(row(cut, 35), row(got, 35));
}

TEST(BlurPhoto, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return BlurPhotoCase::run(queue(), BlurPhotoCase::make(1009, 3)); });
  EXPECT_TRUE(same_bits(a.low, b.low));
}

TEST(BlurPhoto, unknown_distances_of_different_ids_mix_nothing) {
  auto input = BlurPhotoCase::make(1009, 3);
  std::fill(input.distance.begin(), input.distance.end(), std::numeric_limits<float>::quiet_NaN());
  std::iota(input.id.begin(), input.id.end(), 1u);
  const auto low = BlurPhotoCase::run(queue(), input).low;
  for (std::size_t i = 0; i < low.size(); ++i)
    ASSERT_NEAR(low[i], i % 4 == 3 ? 1.0f : input.linear[256 * (i % 4) + input.pixels[i]],
                BlurPhotoCase::kTolerance);
}

TEST(BlurPhoto, never_mixes_across_a_visibility_edge) {
  // A white foreground of one face before a black background of another.
  auto input = BlurPhotoCase::make(60 * 60, 3);
  for (std::size_t i = 0; i < input.count(); ++i) {
    const bool front = i % 60 > 20 && i / 60 > 30;
    input.id[i] = front ? 1 : 2;
    input.distance[i] = front ? 2.0f : 2.5f;
    for (std::size_t k = 0; k < 4; ++k) input.pixels[4 * i + k] = front ? 255 : 0;
  }
  const auto low = BlurPhotoCase::run(queue(), input).low;
  for (std::size_t i = 0; i < input.count(); ++i)
    ASSERT_EQ(low[4 * i], input.pixels[4 * i] ? 1.0f : 0.0f) << i;
}

}  // namespace hybrid::testing
