#include "stages/planes/free_islands.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "stages/planes/plane_floods.hpp"

namespace hybrid::testing::free_islands_test {
namespace {

constexpr int kRows = 40, kCols = 70;

// Islands one by one: all that a flood reaches in steps of up to kUseReach nodes along rows and columns.
std::vector<int> flooded_islands(const RangeImage& image, const std::vector<std::uint8_t>& use) {
  std::vector<int> island(image.count(), -1);
  int count = 0;
  for (std::size_t start = 0; start < use.size(); ++start) {
    if (use[start] != stages::kFree || island[start] >= 0) continue;
    std::vector<std::size_t> reached = {start};
    island[start] = count;
    for (std::size_t next = 0; next < reached.size(); ++next)
      for (int down = -stages::kUseReach; down <= stages::kUseReach; ++down)
        for (int right = -stages::kUseReach; right <= stages::kUseReach; ++right) {
          const int row = static_cast<int>(reached[next]) / kCols + down;
          int col = static_cast<int>(reached[next]) % kCols + right;
          if (image.wraps) col = (col + kCols) % kCols;
          if (row < 0 || row >= kRows || col < 0 || col >= kCols) continue;
          const std::size_t other = image.index(row, col);
          if (use[other] != stages::kFree || island[other] >= 0) continue;
          island[other] = count;
          reached.push_back(other);
        }
    ++count;
  }
  return island;
}

}  // namespace

TEST(FreeIslands, are_what_floods_reach) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    RangeImage image = make_range_image(kRows, kCols);
    image.wraps = seed % 2 == 0;
    std::mt19937 random(seed);
    // From a few samples to most: islands are one or two nodes, many of all shapes, or one.
    std::bernoulli_distribution is_free(0.01 * seed);
    std::vector<std::uint8_t> use(image.count());
    for (auto& one : use)
      one = is_free(random) ? stages::kFree : seed % 3 ? stages::kNotFree : stages::kBlocked;
    const auto expected = flooded_islands(image, use);
    const stages::FreeIslands islands(image, use);
    std::map<int, std::uint32_t> name;
    std::set<std::uint32_t> names, numbers;
    std::size_t free = 0;
    for (std::uint32_t i = 0; i < use.size(); ++i) {
      if (use[i] != stages::kFree) continue;
      const auto [known, is_new] = name.emplace(expected[i], islands.island(i));
      ASSERT_EQ(known->second, islands.island(i)) << "seed " << seed << " sample " << i;
      names.insert(islands.island(i));
      numbers.insert(islands.number(i));
      ++free;
    }
    EXPECT_EQ(names.size(), name.size()) << seed;  // none of two islands
    EXPECT_EQ(islands.count(), names.size()) << seed;
    EXPECT_EQ(numbers.size(), free) << seed;
    if (free > 0) {
      EXPECT_LT(*numbers.rbegin(), islands.numbers()) << seed;
      EXPECT_LT(*names.rbegin(), islands.count()) << seed;
    }
  }
}

}  // namespace hybrid::testing::free_islands_test
