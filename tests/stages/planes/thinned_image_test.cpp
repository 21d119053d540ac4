#include "stages/planes/thinned_image.hpp"

#include <gtest/gtest.h>

namespace hybrid::stages {
namespace {

// Each node's x and y say its row and column.
RangeImage numbered(int rows, int cols, double step_rad) {
  RangeImage image = make_range_image(rows, cols);
  for (int row = 0; row < rows; ++row) image.elevation_rad[static_cast<std::size_t>(row)] = -row * step_rad;
  for (int col = 0; col < cols; ++col) image.azimuth_rad[static_cast<std::size_t>(col)] = col * step_rad;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const std::size_t i = image.index(row, col);
      image.x[i] = static_cast<float>(row);
      image.y[i] = static_cast<float>(col);
      image.mask[i] = row % 2 ? kMeasured : kEmpty;
    }
  return image;
}

TEST(ThinnedImage, a_dense_image_keeps_every_other_third_or_eighth_row_and_column) {
  for (const auto& [step_rad, stride] :
       {std::pair{0.0006, 1}, {0.00045, 2}, {0.00033, 3}, {0.00002, 8}, {0.002, 1}}) {
    const RangeImage whole = numbered(21, 34, step_rad);
    const ThinnedImage thinned(whole);
    ASSERT_EQ(thinned.stride(), stride) << step_rad;
    const RangeImage& image = thinned.image();
    ASSERT_EQ(image.rows, (21 + stride - 1) / stride);
    ASSERT_EQ(image.cols, (34 + stride - 1) / stride);
    for (int row = 0; row < image.rows; ++row)
      for (int col = 0; col < image.cols; ++col) {
        const std::size_t i = image.index(row, col);
        EXPECT_EQ(thinned.whole_index(i), whole.index(row * stride, col * stride));
        EXPECT_EQ(image.x[i], static_cast<float>(row * stride));
        EXPECT_EQ(image.y[i], static_cast<float>(col * stride));
        EXPECT_EQ(image.mask[i], whole.mask[thinned.whole_index(i)]);
      }
  }
}

TEST(ThinnedImage, one_that_is_not_dense_is_itself) {
  const RangeImage whole = numbered(4, 5, 0.001);
  EXPECT_EQ(&ThinnedImage(whole).image(), &whole);
}

}  // namespace
}  // namespace hybrid::stages
