#include "stages/rendering/light_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/colour.hpp"

namespace hybrid::stages {
namespace {

// Columns that brighten, with noise.
Image8 ramp(int width, int height) {
  Image8 image(width, height, 3);
  std::mt19937 random(4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 3; ++k)
        image.at(x, y)[k] =
            static_cast<std::uint8_t>(30 + 150 * x / width + 10 * k + static_cast<int>(random() % 20));
  return image;
}

double mean_of(const Image8& image, int left, int top, int right, int bottom, int channel) {
  double sum = 0;
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) sum += linear_from_srgb(image.at(x, y)[channel] / 255.0);
  return sum / ((right - left + 1) * (bottom - top + 1));
}

TEST(LightCells, small_squares_are_summed_pixel_by_pixel) {
  const Image8 image = ramp(60, 40);
  const LightCells cells(image, 7.5);
  EXPECT_EQ(cells.step_px(), 1);
  for (const auto& [x, y] : {std::pair{30.0, 20.0}, {0.5, 0.5}, {59.5, 39.5}}) {
    const LogLight light = cells.around({x, y});
    const auto low = [](double at) { return std::max(0, static_cast<int>(at - 7.5)); };
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(std::exp(light[static_cast<std::size_t>(k)]),
                  mean_of(image, low(x), low(y), std::min(59, static_cast<int>(x + 7.5)),
                          std::min(39, static_cast<int>(y + 7.5)), k),
                  1e-6);
  }
}

TEST(LightCells, large_squares_are_whole_cells) {
  const Image8 image = ramp(403, 301);  // 6 into neither
  const LightCells cells(image, 50);
  EXPECT_EQ(cells.step_px(), 6);
  for (int k = 0; k < 3; ++k) {
    // 150 to 250 and 100 to 200: cells 25 to 41 and 16 to 33.
    EXPECT_NEAR(std::exp(cells.around({200, 150})[static_cast<std::size_t>(k)]),
                mean_of(image, 150, 96, 251, 203, k), 1e-6);
    EXPECT_NEAR(std::exp(cells.around({402.5, 300.5})[static_cast<std::size_t>(k)]),
                mean_of(image, 348, 246, 402, 300, k), 1e-6);
  }
}

TEST(LightCells, what_is_clipped_dark_or_masked_is_of_no_use) {
  Image8 image(200, 100, 4, 100);
  EXPECT_FALSE(std::isnan(LightCells(image, 20).around({50, 50})[0]));
  for (const auto& [channel, value] : {std::pair{1, 248}, {2, 7}, {3, 0}}) {
    Image8 bad = image;
    bad.at(60, 50)[channel] = static_cast<std::uint8_t>(value);
    const LightCells cells(bad, 20);
    EXPECT_TRUE(std::isnan(cells.around({50, 50})[0])) << channel;
    EXPECT_FALSE(std::isnan(cells.around({150, 50})[0])) << channel;
  }
}

}  // namespace
}  // namespace hybrid::stages
