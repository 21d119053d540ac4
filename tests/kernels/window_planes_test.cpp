#include <gtest/gtest.h>

#include <algorithm>

#include "cases/window_planes_case.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(WindowPlanes, agrees_with_its_reference_at_every_size) {
  for (const std::size_t size : kSizes) {
    const auto input = WindowPlanesCase::make(size, 5);
    const auto got = WindowPlanesCase::run(queue(), input);
    const auto expected = WindowPlanesCase::reference(input);
    ASSERT_EQ(got.size(), expected.shapes.size());
    std::size_t close = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (expected.margin[i] < WindowPlanesCase::kMargin)
        ++close;
      else
        ASSERT_EQ(got[i], expected.shapes[i]) << "size " << size << " sample " << i;
    }
    EXPECT_LE(close, got.size() / 50 + 1);
  }
}

TEST(WindowPlanes, case_has_windows_of_every_shape_and_none) {
  const auto shapes = WindowPlanesCase::reference(WindowPlanesCase::make(10007, 5)).shapes;
  for (std::uint8_t shape = 0; shape <= WINDOW_SHAPES; ++shape)
    EXPECT_GT(std::count(shapes.begin(), shapes.end(), shape), 10) << int{shape};
}

TEST(WindowPlanes, finds_nothing_where_nothing_is_free) {
  auto input = WindowPlanesCase::make(1009, 5);
  std::fill(input.free.begin(), input.free.end(), std::uint8_t{0});
  for (auto* axis : {&input.x, &input.y, &input.z}) std::fill(axis->begin(), axis->end(), NAN);
  for (const std::uint8_t shape : WindowPlanesCase::run(queue(), input)) ASSERT_EQ(shape, 0);
}

// Coordinates that are NaN though marked free make no plane, and no index out of bounds.
TEST(WindowPlanes, samples_that_are_nan_make_no_plane) {
  auto input = WindowPlanesCase::make(1009, 5);
  for (auto* axis : {&input.x, &input.y, &input.z}) std::fill(axis->begin(), axis->end(), NAN);
  for (const std::uint8_t shape : WindowPlanesCase::run(queue(), input)) ASSERT_EQ(shape, 0);
}

TEST(WindowPlanes, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  auto input = WindowPlanesCase::make(1009, 5);
  const auto [a, b] = at_two_work_group_sizes([&] { return WindowPlanesCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a, b));
  for (const int width : vector_widths()) {
    input.vector_width = width;
    EXPECT_TRUE(same_bits(WindowPlanesCase::run(queue(), input), a)) << width;
  }
}

}  // namespace hybrid::testing
