#include "stages/contours/contour_mask.hpp"

#include <gtest/gtest.h>

#include <string>

namespace hybrid::testing {
namespace {

// One digit per sample.
std::string clean(const std::vector<std::string>& rows, bool wraps, int least) {
  RangeImage image = make_range_image(static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
  image.wraps = wraps;
  std::vector<std::uint32_t> labels;
  for (const auto& row : rows)
    for (const char c : row) labels.push_back(static_cast<std::uint32_t>(c - '0'));
  const auto before = labels;
  const auto changes = stages::clean_labels(image, labels, least);
  std::string result;
  for (const std::uint32_t label : labels) result += static_cast<char>('0' + label);
  stages::restore_labels(changes, labels);
  EXPECT_EQ(labels, before);
  return result;
}

}  // namespace

TEST(ContourMask, fills_holes_and_removes_specks) {
  EXPECT_EQ(clean({"11110000", "10110000", "10110020", "11110000"}, false, 4),
            "11110000"
            "11110000"
            "11110000"
            "11110000");
}

TEST(ContourMask, keeps_patches_of_the_least_size) {
  EXPECT_EQ(clean({"11111", "10011", "10011", "11111"}, false, 4), "11111100111001111111");
  EXPECT_EQ(clean({"11111", "10011", "10111", "11111"}, false, 4), "11111111111111111111");
}

TEST(ContourMask, gap_between_two_labels_stays_a_gap) {
  EXPECT_EQ(clean({"1111", "1111", "1001", "2222", "2222"}, false, 4), "11111111100122222222");
  EXPECT_EQ(clean({"1111", "1111", "1011", "2222", "2222"}, false, 4), "11111111111122222222");
  EXPECT_EQ(clean({"1111", "1111", "0000", "2222", "2222"}, false, 5), "11111111000022222222");
}

TEST(ContourMask, patches_continue_across_the_seam_only_when_the_image_wraps) {
  const std::vector<std::string> rows = {"2111112", "2111112", "1111111", "1111111"};
  EXPECT_EQ(clean(rows, true, 4),
            "2111112"
            "2111112"
            "1111111"
            "1111111");
  EXPECT_EQ(clean(rows, false, 4).find('2'), std::string::npos);
}

TEST(ContourMask, border_is_no_part_of_a_rim) {
  EXPECT_EQ(clean({"1001", "1111", "1111"}, false, 3), "111111111111");
  EXPECT_EQ(clean({"22", "22"}, false, 9), "2222");  // nothing to become
}

TEST(ContourMask, speck_in_another_label_joins_it) {
  EXPECT_EQ(clean({"1111", "1211", "1111"}, false, 4), "111111111111");
}

}  // namespace hybrid::testing
