#include "cases/contour_cells_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "device.hpp"

namespace hybrid::testing {

TEST(ContourCells, equals_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = ContourCellsCase::make(size, 2);
    EXPECT_EQ(ContourCellsCase::run(queue(), input), ContourCellsCase::reference(input)) << size;
  }
}

TEST(ContourCells, case_meets_every_code_of_a_corner) {
  std::set<int> codes;
  for (const std::uint16_t code : ContourCellsCase::reference(ContourCellsCase::make(100003, 2)))
    codes.insert(code & 15);
  EXPECT_EQ(codes.size(), 9u);  // 0 and the eight sets that hold corner 0
}

TEST(ContourCells, no_labels_or_one_label_make_no_contour) {
  auto input = ContourCellsCase::make(1009, 2);
  for (const std::uint32_t label : {0u, 7u}) {
    std::fill(input.labels.begin(), input.labels.end(), label);
    for (const std::uint16_t code : ContourCellsCase::run(queue(), input))
      ASSERT_EQ(code, label ? 0xffff : 0);
  }
}

TEST(ContourCells, gives_the_same_bits_at_two_work_group_sizes) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return ContourCellsCase::run(queue(), ContourCellsCase::make(1009, 2)); });
  EXPECT_TRUE(same_bits(a, b));
}

}  // namespace hybrid::testing
