#include "stages/contours/class_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace hybrid::testing::class_picture_test {
namespace {

RangeImage full_image(int rows, int cols) {
  RangeImage image = make_range_image(rows, cols);
  std::fill(image.mask.begin(), image.mask.end(), std::uint8_t{kMeasured});
  for (std::size_t i = 0; i < image.count(); ++i) image.range_m[i] = 1 + static_cast<float>(i);
  return image;
}

int brightness(const std::uint8_t* pixel) {
  return pixel[0] + pixel[1] + pixel[2];
}

}  // namespace

TEST(ClassPicture, shows_classes_and_labels) {
  RangeImage image = full_image(2, 8);
  PlaneSegmentation segmentation;
  segmentation.square = 2;
  segmentation.square_rows = 1;
  segmentation.square_cols = 4;
  segmentation.square_class = {kUndersampled, kNonPlanar, kPlanarTooSmall, kSuperclusterMember};
  segmentation.sample_label.assign(16, 0);
  segmentation.sample_label[image.index(0, 6)] = 1;
  image.mask[image.index(1, 7)] = kEmpty;
  const Image8 picture = stages::class_picture(image, segmentation);
  ASSERT_EQ(picture.channels, 3);
  EXPECT_EQ(brightness(picture.at(0, 0)), 0);
  const auto* green = picture.at(2, 0);
  EXPECT_TRUE(green[1] > green[0] && green[1] > green[2] && green[1] < 128);
  const auto* blue = picture.at(4, 1);
  EXPECT_TRUE(blue[2] > blue[0] && blue[2] > blue[1] && blue[2] < 128);
  EXPECT_GT(brightness(picture.at(6, 0)), 450);
  EXPECT_TRUE(std::equal(picture.at(7, 0), picture.at(7, 0) + 3, green));  // an outlier in a member square
  EXPECT_EQ(brightness(picture.at(7, 1)), 0);
}

TEST(ClassPicture, successive_ids_are_told_apart_and_pale) {
  RangeImage image = full_image(1, 60);
  PlaneSegmentation segmentation;
  segmentation.square = 60;
  segmentation.square_rows = segmentation.square_cols = 1;
  segmentation.square_class = {kSuperclusterMember};
  for (std::uint32_t id = 1; id <= 60; ++id) segmentation.sample_label.push_back(id);
  const Image8 picture = stages::class_picture(image, segmentation);
  for (int a = 0; a < 60; ++a) {
    EXPECT_GE(*std::min_element(picture.at(a, 0), picture.at(a, 0) + 3), 80);
    for (int b = a + 1; b < std::min(a + 5, 60); ++b) {
      int difference = 0;
      for (int k = 0; k < 3; ++k) difference += std::abs(picture.at(a, 0)[k] - picture.at(b, 0)[k]);
      EXPECT_GT(difference, 40) << a + 1 << " " << b + 1;
    }
  }
}

TEST(RangePicture, near_is_bright_and_no_return_black) {
  RangeImage image = full_image(10, 10);
  image.range_m[50] = std::numeric_limits<float>::quiet_NaN();
  const Image8 picture = stages::range_picture(image);
  ASSERT_EQ(picture.channels, 1);
  EXPECT_GT(picture.pixels[0], 200);
  EXPECT_EQ(picture.pixels[50], 0);
  EXPECT_GT(picture.pixels[99], 20);
  for (std::size_t i = 51; i < 99; ++i) EXPECT_GE(picture.pixels[i], picture.pixels[i + 1]);
  EXPECT_EQ(stages::range_picture(make_range_image(3, 3)).pixels, std::vector<std::uint8_t>(9, 0));
  EXPECT_TRUE(stages::range_picture(make_range_image(0, 0)).pixels.empty());
}

}  // namespace hybrid::testing::class_picture_test
