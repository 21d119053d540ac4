#include "stages/scan/interleaving.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "stages/room_scan.hpp"

namespace hybrid::testing::interleaving_test {
namespace {

constexpr int kRows = 20, kCols = 30;

double share(const std::function<std::uint32_t(int row, int col)>& label, double angle_deg) {
  const RangeImage image = make_range_image(kRows, kCols);
  const double angle = angle_deg * M_PI / 180;
  PlaneSegmentation planes;
  planes.superclusters.resize(2);
  planes.superclusters[0].plane.normal = Vec3::UnitX();
  planes.superclusters[1].plane.normal = {std::cos(angle), std::sin(angle), 0};
  for (int row = 0; row < kRows; ++row)
    for (int col = 0; col < kCols; ++col) planes.sample_label.push_back(label(row, col));
  return stages::interleaved_share(image, planes);
}

}  // namespace

TEST(Interleaving, rows_of_two_planes_that_take_turns_lie_between_each_other) {
  // All but the first and the last row.
  EXPECT_DOUBLE_EQ(share([](int row, int) { return 1 + row % 2; }, 1), (kRows - 2.0) / kRows);
  EXPECT_DOUBLE_EQ(share([](int, int col) { return 1 + col % 2; }, 1), (kCols - 2.0) / kCols);
}

TEST(Interleaving, a_border_is_none) {
  EXPECT_EQ(share([](int, int col) { return col < 13 ? 1 : 2; }, 1), 0);
  EXPECT_EQ(share([](int, int) { return 1; }, 1), 0);
  EXPECT_EQ(share([](int, int) { return 0; }, 1), 0);
}

TEST(Interleaving, planes_that_are_turned_may_take_turns) {  // the slats of a blind
  EXPECT_EQ(share([](int row, int) { return 1 + row % 2; }, 20), 0);
}

TEST(Interleaving, samples_on_no_plane_lie_between_none) {
  EXPECT_EQ(share([](int row, int) { return row % 2; }, 1), 0);
}

}  // namespace hybrid::testing::interleaving_test
