#include "stages/plane_floods.hpp"

#include <gtest/gtest.h>

#include "room_scan.hpp"

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

}  // namespace
}  // namespace hybrid::testing
