#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/colour.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::testing::image_quality_test {
namespace {

Image8 noise(int width, int height, std::uint32_t seed) {
  Image8 image(width, height, 3);
  std::mt19937 random(seed);
  for (auto& value : image.pixels) value = static_cast<std::uint8_t>(40 + random() % 120);
  return image;
}

ImageF decode(const Image8& image, double gain = 1) {
  ImageF linear(image.width, image.height, 3);
  for (std::size_t i = 0; i < linear.pixels.size(); ++i)
    linear.pixels[i] = static_cast<float>(gain * linear_from_srgb(image.pixels[i] / 255.0));
  return linear;
}

std::vector<std::uint8_t> everywhere(const Image8& image) {
  return std::vector<std::uint8_t>(static_cast<std::size_t>(image.width * image.height), 1);
}

}  // namespace

TEST(ImageQuality, is_perfect_for_the_image_itself_at_any_exposure) {
  const Image8 image = noise(40, 30, 1);
  for (double gain : {1.0, 0.4, 1.7}) {
    const auto quality = stages::compare_images(decode(image, gain), image, everywhere(image));
    EXPECT_GT(quality.psnr_db, 90);
    EXPECT_NEAR(quality.ssim, 1, 1e-6);
    EXPECT_EQ(quality.share_seen, 1);
  }
}

TEST(ImageQuality, measures_a_known_error) {
  // +-5 of 255 in every value, alternating, so that no gain explains it: 10 log10(255^2 / 25) = 34.15 dB.
  const Image8 image = noise(64, 64, 2);
  Image8 changed = image;
  for (std::size_t i = 0; i < changed.pixels.size(); ++i)
    changed.pixels[i] = static_cast<std::uint8_t>(changed.pixels[i] + ((i / 3 + i / 192) % 2 ? 5 : -5));
  const auto quality = stages::compare_images(decode(changed), image, everywhere(image));
  EXPECT_NEAR(quality.psnr_db, 34.15, 0.05);
  EXPECT_LT(quality.ssim, 0.999);
  EXPECT_GT(quality.ssim, 0.9);
}

TEST(ImageQuality, looks_only_at_the_mask_and_at_finite_pixels) {
  const Image8 image = noise(40, 30, 1);
  ImageF linear = decode(image);
  std::vector<std::uint8_t> mask = everywhere(image);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 20; ++x) {
      for (int k = 0; k < 3; ++k) linear.at(x, y)[k] = x < 10 ? NAN : 9.0f;
      if (x >= 10) mask[static_cast<std::size_t>(40 * y + x)] = 0;
    }
  const auto quality = stages::compare_images(linear, image, mask);
  EXPECT_GT(quality.psnr_db, 90);
  EXPECT_NEAR(quality.ssim, 1, 1e-6);
  EXPECT_EQ(quality.share_seen, 0.5);
  const auto nothing = stages::compare_images(linear, image, std::vector<std::uint8_t>(1200, 0));
  EXPECT_EQ(nothing.psnr_db + nothing.ssim + nothing.share_seen, 0);
}

TEST(ImageQuality, rejects_images_of_different_sizes) {
  const Image8 image = noise(4, 3, 1);
  EXPECT_THROW(stages::compare_images(ImageF(3, 4, 3), image, everywhere(image)), Error);
  EXPECT_THROW(stages::compare_images(decode(image), image, {}), Error);
}

}  // namespace hybrid::testing::image_quality_test
