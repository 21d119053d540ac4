#include "stages/planes/sample_marks.hpp"

#include <gtest/gtest.h>

namespace hybrid::stages {
namespace {

// The mark of the i-th sample is i + 1.
void expect_marks_of(std::uint32_t count, std::uint32_t apart) {
  SampleMarks marks;
  for (std::uint32_t i = 0; i < count; ++i) marks.of(i * apart) = i + 1;
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(marks.of(i * apart), i + 1) << i << " of " << apart;
  ASSERT_EQ(marks.of(count * apart), 0u);
  marks.clear();
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(marks.of(i * apart), 0u) << i << " of " << apart;
}

}  // namespace

// A jamb is a column or two of the image wide, thousands of samples high: all lie at one place of their row
// of sixteen.
TEST(SampleMarks, hold_a_column_of_any_image_in_a_table_of_any_size) {
  for (const std::uint32_t cols : {1u, 15u, 16u, 17u, 1024u, 4096u, 6324u, 6336u, 20000u, 65536u})
    for (const std::uint32_t rows : {1u, 255u, 256u, 257u, 2047u, 2048u, 2049u, 30000u})
      expect_marks_of(rows, cols);
}

}  // namespace hybrid::stages
