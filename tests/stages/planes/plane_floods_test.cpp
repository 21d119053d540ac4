#include "stages/planes/plane_floods.hpp"

#include <gtest/gtest.h>

#include "stages/room_scan.hpp"

namespace hybrid::testing {
namespace {

// A piece of a wall, too small for what is asked, with a seed at each of its windows.
struct SmallPiece {
  static constexpr int kSide = 10;
  RangeImage image = image_room(kSide, kSide, 0.002, 0);
  std::vector<std::uint8_t> use = std::vector<std::uint8_t>(image.count(), stages::kFree);
  stages::BlockFloods floods{image, use, stages::RangeNoise{0.001}, {0, 0, kSide, kSide}};

  // Floods from every open seed; how many there were.
  int flood_all(std::size_t least) {
    int count = 0;
    for (int row = 0; row + 4 <= kSide; ++row)
      for (int col = 0; col + 4 <= kSide; ++col) {
        const auto i = static_cast<std::uint32_t>(image.index(row, col));
        if (!floods.is_open(i)) continue;
        EXPECT_EQ(floods.flood({i, 0, i, 0}, least), image.count());
        ++count;
      }
    return count;
  }
};

TEST(BlockFloods, a_large_flood_closes_its_samples) {
  SmallPiece piece;
  EXPECT_EQ(piece.flood_all(piece.image.count()), 1);
}

TEST(BlockFloods, a_plane_that_is_too_small_is_not_flooded_from_each_of_its_seeds) {
  SmallPiece piece;
  EXPECT_EQ(piece.flood_all(piece.image.count() + 1), 16);
}

// A block of 20 x 16 samples, and through a neck one sample wide a piece of 6 x `far` beside it.
TEST(PlaneFlooder, a_flood_loses_what_hangs_on_it_by_a_sample_s_width) {
  const RangeImage image = image_room(30, 60, 0.002, 0);
  const std::vector<std::uint8_t> use(image.count(), stages::kFree);
  const stages::PlaneFlooder flooder(image, use, stages::RangeNoise{0.001});
  const auto flood_of = [&](int far) {
    stages::PlaneFlood flood;
    for (int row = 0; row < image.rows; ++row)
      for (int col = 0; col < image.cols; ++col)
        if ((row >= 4 && row < 24 && col >= 2 && col < 18) || (row == 12 && col >= 18 && col < 24) ||
            (row >= 10 && row < 16 && col >= 24 && col < 24 + far))
          flood.samples.push_back(static_cast<std::uint32_t>(image.index(row, col)));
    return flood;
  };
  const auto body = flooder.without_tongues(flood_of(10));
  // But its corners, which no sample inside touches, and with the first of the neck, which one does.
  EXPECT_EQ(body.samples.size(), 20u * 16u - 4u + 1u);
  for (const std::uint32_t i : body.samples) EXPECT_LE(static_cast<int>(i) % image.cols, 18);
  // Where it is no tongue but as much again, nobody knows which of the two is the plane.
  EXPECT_TRUE(flooder.without_tongues(flood_of(36)).samples.empty());
}

}  // namespace
}  // namespace hybrid::testing
