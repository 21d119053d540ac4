#include "stages/planes/rejoin_planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace hybrid::testing::rejoin_planes_test {
namespace {

constexpr int kSide = 40, kSquare = 4;
constexpr int kRailTop = 20, kRailBottom = 24;  // rows
constexpr double kSigma_m = 0.001, kWall_m = 5;

// A wall 5 m ahead in two parts, labels 1 above and 2 below a rail of label 3. Heights in metres towards the
// scanner; `tilt` turns the plane of the lower part, not its samples, about the row through its middle.
struct Wall {
  double rail_m = 0.05, lower_m = 0, tilt = 0;
  bool upper_owned = false, lower_owned = false;  // the parts' squares
  // The lower part's plane lies this far before its samples, and has those that are nearer to it: the upper
  // part's has the others, or none has.
  double turns_m = 0;
  bool others_labelled = true;

  RangeImage image = make_range_image(kSide, kSide);
  std::vector<std::uint32_t> labels = std::vector<std::uint32_t>(image.count());
  stages::PlaneRegions regions;
  stages::SquarePresence presence;

  std::vector<std::uint32_t> rejoin() {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, kSigma_m);
    stages::SquarePlanes squares;
    squares.square = kSquare;
    squares.rows = squares.cols = kSide / kSquare;
    squares.sigma_m = kSigma_m;
    squares.noise = {kSigma_m};
    const stages::SquareGrid grid(image, squares);
    regions.of_square.resize(grid.count());
    regions.regions.resize(3);
    for (int row = 0; row < kSide; ++row)
      for (int col = 0; col < kSide; ++col) {
        const std::size_t i = image.index(row, col);
        labels[i] = row < kRailTop ? 1 : row < kRailBottom ? 3 : 2;
        const double height = row < kRailTop ? 0 : row < kRailBottom ? rail_m : lower_m;
        image.mask[i] = kMeasured;
        const double before = -noise(random);
        if (labels[i] == 2 && turns_m > 0 && before < turns_m / 2) labels[i] = others_labelled ? 1 : 0;
        image.x[i] = static_cast<float>(kWall_m - height - before);
        image.y[i] = static_cast<float>(0.01 * (col - kSide / 2));
        image.z[i] = static_cast<float>(0.01 * (kSide / 2 - row));
        const auto square = static_cast<std::uint32_t>(grid.at(row / kSquare, col / kSquare));
        if (row % kSquare == 0 && col % kSquare == 0) {
          const std::uint32_t part = row < kRailTop ? 1 : row < kRailBottom ? 3 : 2;
          regions.regions[part - 1].squares.push_back(square);
          presence.emplace_back(square, part);
        }
      }
    const std::array<bool, 3> own = {upper_owned, lower_owned, false};
    for (std::uint32_t id = 1; id <= 3; ++id) {
      regions.regions[id - 1].small = !own[id - 1];
      for (const std::uint32_t square : regions.regions[id - 1].squares)
        if (own[id - 1]) regions.of_square[square] = id;
    }
    const double middle_z = 0.01 * (kSide / 2 - (kRailBottom + kSide) / 2.0);
    const Vec3 tilted(-std::cos(tilt), 0, std::sin(tilt));
    const std::vector<Plane> planes = {{-Vec3::UnitX(), -kWall_m},
                                       {tilted, tilted.dot(Vec3(kWall_m - lower_m - turns_m, 0, middle_z))},
                                       {-Vec3::UnitX(), -(kWall_m - rail_m)}};
    return stages::rejoin_planes(image, squares, grid, {}, planes, labels, regions, presence);
  }
  std::uint32_t below() const { return labels[image.index(kSide - 1, 0)]; }
};

}  // namespace

TEST(RejoinPlanes, a_wall_behind_a_rail_is_one) {
  Wall wall;
  EXPECT_EQ(wall.rejoin(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(wall.labels[0], 1u);
  EXPECT_EQ(wall.below(), 1u);
  EXPECT_EQ(wall.labels[wall.image.index(kRailTop, 0)], 3u);
  EXPECT_EQ(wall.regions.regions[0].squares.size(), 90u);
  EXPECT_TRUE(wall.regions.regions[1].squares.empty());
  for (const auto& [square, id] : wall.presence) EXPECT_NE(id, 2u);
}

TEST(RejoinPlanes, a_part_that_strangers_tilted_is_the_walls_all_the_same) {
  Wall wall;
  wall.tilt = 0.012;  // within the noise at the part's upper and lower edge, almost
  EXPECT_FALSE(wall.rejoin().empty());
  EXPECT_EQ(wall.labels[0], wall.below());
}

TEST(RejoinPlanes, parts_with_a_view_between_them_stay_two) {
  Wall wall;
  wall.rail_m = -1;
  EXPECT_TRUE(wall.rejoin().empty());
  EXPECT_EQ(wall.labels[0], 1u);
  EXPECT_EQ(wall.below(), 2u);
}

TEST(RejoinPlanes, a_step_beyond_the_noise_stays) {
  Wall wall;
  wall.lower_m = 0.003;
  EXPECT_TRUE(wall.rejoin().empty());
  EXPECT_EQ(wall.below(), 2u);
}

// Two planes with less than two standard deviations between them took turns on one wall, sample by sample.
TEST(RejoinPlanes, planes_that_take_turns_on_a_wall_are_one) {
  Wall wall;
  wall.turns_m = 1.6 * kSigma_m;
  EXPECT_EQ(wall.rejoin(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(std::count(wall.labels.begin(), wall.labels.end(), 2u), 0);
}

// ... as far from the other plane, but alone: it may lie on another board.
TEST(RejoinPlanes, planes_as_near_that_do_not_take_turns_stay_two) {
  Wall wall;
  wall.turns_m = 1.6 * kSigma_m;
  wall.others_labelled = false;
  EXPECT_TRUE(wall.rejoin().empty());
  EXPECT_GT(std::count(wall.labels.begin(), wall.labels.end(), 2u), 100);
}

TEST(RejoinPlanes, a_plane_that_owns_squares_takes_a_larger_small_one) {
  Wall wall;
  wall.lower_owned = true;
  EXPECT_EQ(wall.rejoin(), std::vector<std::uint32_t>{2});
  EXPECT_EQ(wall.labels[0], 2u);
  EXPECT_EQ(wall.regions.regions[1].squares.size(), 40u);
  EXPECT_EQ(std::count(wall.regions.of_square.begin(), wall.regions.of_square.end(), 2u), 40);
}

TEST(RejoinPlanes, the_part_of_two_that_own_squares_hands_them_over) {
  Wall wall;
  wall.upper_owned = wall.lower_owned = true;
  EXPECT_EQ(wall.rejoin(), std::vector<std::uint32_t>{1});
  EXPECT_EQ(wall.regions.regions[0].squares.size(), 90u);
  EXPECT_EQ(std::count(wall.regions.of_square.begin(), wall.regions.of_square.end(), 1u), 90);
}

}  // namespace hybrid::testing::rejoin_planes_test
