#include "geometry/shoulder.hpp"

#include <gtest/gtest.h>

#include <array>

namespace hybrid {

TEST(Shoulder, leaves_the_darker_half_and_takes_white_to_1) {
  for (const double white : {1.01, 1.5, 2.3, 40.0}) {
    const Shoulder shoulder(white);
    EXPECT_EQ(shoulder.level(0.3), 0.3);
    EXPECT_EQ(shoulder.level(0.5), 0.5);
    EXPECT_NEAR(shoulder.level(white), 1, 1e-12);
    double before = 0;
    for (double light = 0.01; light < white; light += 0.01) {
      EXPECT_GT(shoulder.level(light), before);
      EXPECT_LE(shoulder.level(light), light);
      before = shoulder.level(light);
    }
    EXPECT_LT(before, 1);
  }
}

TEST(Shoulder, changes_nothing_where_nothing_is_lighter_than_white) {
  for (const double white : {0.0, 0.5, 1.0}) {
    const Shoulder shoulder(white);
    std::array<float, 3> rgb{0.25f, 1, 0.75f};
    shoulder.apply(rgb.data());
    EXPECT_EQ(rgb, (std::array<float, 3>{0.25f, 1, 0.75f}));
    EXPECT_EQ(shoulder.level(1.7), 1.7);
  }
}

TEST(Shoulder, keeps_hues) {
  std::array<float, 3> rgb{2, 1, 0.5f};
  Shoulder(2).apply(rgb.data());
  EXPECT_NEAR(rgb[0], 1, 1e-6);
  EXPECT_NEAR(rgb[1], 0.5, 1e-6);
  EXPECT_NEAR(rgb[2], 0.25, 1e-6);
}

}  // namespace hybrid
