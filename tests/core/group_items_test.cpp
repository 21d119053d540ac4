#include "core/group_items.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace hybrid {
namespace {

// More items than one block has, so that blocks meet within groups.
TEST(GroupItems, each_group_has_its_values_in_their_order) {
  constexpr std::size_t kItems = 300'000, kGroups = 37;
  std::vector<std::uint32_t> group_of(kItems);
  std::minstd_rand random(1);
  for (auto& group : group_of)
    if ((group = static_cast<std::uint32_t>(random() % (kGroups + 1))) == 20 || group == kGroups)
      group = kNoGroup;
  std::vector<std::vector<std::uint32_t>> wanted(kGroups);
  const auto value_of = [](std::size_t i) { return static_cast<std::uint32_t>(2 * i); };
  for (std::size_t i = 0; i < kItems; ++i)
    if (group_of[i] != kNoGroup) wanted[group_of[i]].push_back(value_of(i));

  const ItemGroups groups = group_items(
      kItems, kGroups, [&](std::size_t i) { return group_of[i]; }, value_of);
  ASSERT_EQ(groups.begin.size(), kGroups + 1);
  for (std::size_t g = 0; g < kGroups; ++g)
    EXPECT_EQ(std::vector(groups.values.begin() + static_cast<std::ptrdiff_t>(groups.begin[g]),
                          groups.values.begin() + static_cast<std::ptrdiff_t>(groups.begin[g + 1])),
              wanted[g])
        << g;
  EXPECT_EQ(groups.values.size(), groups.begin.back());
}

TEST(GroupItems, no_items_make_empty_groups) {
  const ItemGroups groups = group_items(
      0, 3, [](std::size_t) { return 0u; }, [](std::size_t) { return 0u; });
  EXPECT_EQ(groups.begin, (std::vector<std::size_t>{0, 0, 0, 0}));
  EXPECT_TRUE(groups.values.empty());
}

}  // namespace
}  // namespace hybrid
