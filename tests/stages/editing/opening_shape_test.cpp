#include "stages/editing/opening_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace hybrid::stages::opening_shape_test {
namespace {

constexpr double kCell_m = 0.01;
constexpr int kDense = 4;  // samples of the leaf a place

// A door of 1.9 by 2.2 m from (1, 0.5) in a wall, marks 2 cm apart. A leaf stands before its left jamb:
// behind it, 14 cm of the door and 10 cm of the wall are seen by another scan only, whose samples are 10 cm
// apart.
std::vector<EvidenceMark> door_behind_leaf() {
  std::vector<EvidenceMark> marks;
  const auto add = [&](double u, double v, CellEvidence kind) {
    marks.push_back({Vec2(u, v).cast<float>(), 0, kind});
  };
  for (int i = 0; i < 200; ++i)
    for (int k = 0; k < 160; ++k) {
      const double u = 0.005 + 0.02 * i, v = 0.005 + 0.02 * k;
      const bool open =
          u > 1 && u < 2.9 && v > 0.5 && v<2.7, hidden = u> 0.9 && u < 1.14 && v > 0.5 && v < 2.9;
      if (!hidden) add(u, v, open ? CellEvidence::through : CellEvidence::closed);
      if (hidden && k % 5 == 0 && u < 1.1) add(u, v, open ? CellEvidence::behind : CellEvidence::closed);
      for (int dense = 0; hidden && u > 1.12 && dense < kDense; ++dense) add(u, v, CellEvidence::attached);
    }
  return marks;
}

}  // namespace

TEST(OpeningShape, a_leaf_before_a_jamb_is_not_the_jamb) {
  const auto ring =
      regular_border({{1.14, 0.5}, {2.9, 0.5}, {2.9, 2.7}, {1.14, 2.7}}, door_behind_leaf(), kCell_m);
  ASSERT_TRUE(ring);
  const auto [left, right] = std::minmax_element(ring->begin(), ring->end(),
                                                 [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
  EXPECT_NEAR(left->x(), 1.0, 0.02);
  EXPECT_NEAR(right->x(), 2.9, 0.02);
}

}  // namespace hybrid::stages::opening_shape_test
