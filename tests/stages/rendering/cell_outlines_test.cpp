#include "stages/rendering/cell_outlines.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <string>

namespace hybrid::testing::cell_outlines_test {
namespace {

using stages::cell_outlines;

// Rows of text, the lowest first; '#' is set.
std::vector<std::uint8_t> cells(const std::vector<std::string>& rows) {
  std::vector<std::uint8_t> set;
  for (const auto& row : rows)
    for (const char c : row) set.push_back(c == '#');
  return set;
}

double area(const stages::CellOutline& outline) {
  return std::accumulate(outline.holes.begin(), outline.holes.end(), signed_area(outline.outer),
                         [](double sum, const Ring2& hole) { return sum + signed_area(hole); });
}

}  // namespace

TEST(CellOutlines, ARectangleHasFourCorners) {
  const auto found = cell_outlines(cells({"....", ".##.", ".##.", "...."}), 4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].outer, (Ring2{{1, 1}, {3, 1}, {3, 3}, {1, 3}}));
  EXPECT_TRUE(found[0].holes.empty());
}

TEST(CellOutlines, PartsAndHoles) {
  const auto found = cell_outlines(cells({"#####..", "#...#.#", "#.#.#..", "#...#..", "#####.."}), 7);
  ASSERT_EQ(found.size(), 3u);
  ASSERT_EQ(found[0].holes.size(), 1u);
  EXPECT_EQ(area(found[0]), 16);
  EXPECT_EQ(signed_area(found[0].holes[0]), -9);
  EXPECT_EQ(area(found[1]), 1);
  EXPECT_EQ(area(found[2]), 1);
}

TEST(CellOutlines, CellsThatTouchAtACornerAreTwoParts) {
  for (const auto& rows : {std::vector<std::string>{"#.", ".#"}, {".#", "#."}}) {
    const auto found = cell_outlines(cells(rows), 2);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].outer.size(), 4u);
    EXPECT_EQ(found[1].outer.size(), 4u);
  }
}

TEST(CellOutlines, NothingHasNone) {
  EXPECT_TRUE(cell_outlines({}, 0).empty());
  EXPECT_TRUE(cell_outlines(cells({"..", ".."}), 2).empty());
}

TEST(CellOutlines, AnyCellsKeepTheirArea) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const int cols = 1 + static_cast<int>(random() % 12), rows = 1 + static_cast<int>(random() % 12);
    std::vector<std::uint8_t> set(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows));
    for (auto& cell : set) cell = random() % 3 != 0;
    double sum = 0;
    for (const auto& outline : cell_outlines(set, cols)) {
      EXPECT_GT(signed_area(outline.outer), 0);
      for (const auto& hole : outline.holes) EXPECT_LT(signed_area(hole), 0);
      sum += area(outline);
    }
    EXPECT_EQ(sum, std::accumulate(set.begin(), set.end(), 0));
  }
}

}  // namespace hybrid::testing::cell_outlines_test
