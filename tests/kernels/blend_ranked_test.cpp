#include <gtest/gtest.h>

#include <algorithm>

#include "cases/blend_ranked_case.hpp"
#include "device.hpp"

namespace hybrid::testing {
namespace {

float plane(const BlendRankedCase::Output& out, std::size_t plane, std::size_t i) {
  return out.sums[plane * out.best.size() + i];
}

// One point straight ahead of all photographs, with the given ranks.
BlendRankedCase::Input one_point(const std::vector<float>& penalties, std::uint32_t kept) {
  auto input = BlendRankedCase::make(1, 3);
  auto& blend = input.rank.blend;
  blend.surface = {0, 0, 0, 0, -1, 0, 0};
  blend.mix.mode = BLEND_LINEAR;
  for (std::size_t j = 0; j < blend.photos.size(); ++j)
    std::fill(blend.photos[j].pixels.begin(), blend.photos[j].pixels.end(), j == 0 ? 255 : 0);
  input.rank.kept = kept;
  input.ranks.penalty.assign(kept, std::numeric_limits<float>::infinity());
  input.ranks.photo.assign(kept, -1);
  for (std::size_t r = 0; r < penalties.size(); ++r) {
    input.ranks.penalty[r] = penalties[r];
    input.ranks.photo[r] = static_cast<int>(r);
  }
  return input;
}

}  // namespace

TEST(BlendRanked, agrees_with_its_reference_at_every_size_and_in_every_mode) {
  for (std::size_t size : kSizes)
    for (const auto& [mode, bands] : kBlendMixes) {
      if (size > 2000 && bands < 4) continue;
      auto input = BlendRankedCase::make(size, 4);
      input.rank.blend.mix.mode = mode;
      input.rank.blend.mix.bands = bands;
      const auto got = BlendRankedCase::run(queue(), input);
      const auto expected = BlendRankedCase::reference(input);
      std::size_t wrong = 0, coloured = 0;
      for (std::size_t i = 0; i < input.rank.blend.count(); ++i) {
        wrong += !BlendRankedCase::agrees(got, expected, i);
        coloured += expected.best[i] >= 0;
      }
      EXPECT_LE(static_cast<double>(wrong), BlendRankedCase::kUndecided * static_cast<double>(size)) << size;
      if (size > 100) {
        EXPECT_GT(coloured, size / 4);
      }
    }
}

TEST(BlendRanked, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  auto input = BlendRankedCase::make(1009, 5);
  const auto [a, b] = at_two_work_group_sizes([&] { return BlendRankedCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a.sums, b.sums));
  EXPECT_EQ(a.best, b.best);
  for (int width : vector_widths()) {
    input.rank.blend.vector_width = width;
    const auto other = BlendRankedCase::run(queue(), input);
    EXPECT_TRUE(same_bits(a.sums, other.sums)) << width;
    EXPECT_EQ(a.best, other.best) << width;
  }
}

TEST(BlendRanked, points_without_ranks_get_nothing) {
  auto input = BlendRankedCase::make(129, 1);
  std::fill(input.ranks.photo.begin(), input.ranks.photo.end(), -1);
  const auto out = BlendRankedCase::run(queue(), input);
  EXPECT_EQ(std::count(out.sums.begin(), out.sums.end(), 0.0f), static_cast<std::ptrdiff_t>(out.sums.size()));
  EXPECT_EQ(std::count(out.best.begin(), out.best.end(), -1), 129);
}

TEST(BlendRanked, the_last_rank_ends_the_others_and_has_no_weight_itself) {
  // 1 - 0.1 / 0.4 over 0.1, 1 - 0.2 / 0.4 over 0.2, and the third ends them.
  const auto out = BlendRankedCase::run(queue(), one_point({0.1f, 0.2f, 0.4f}, 3));
  const float first = 0.75f / 0.101f, second = 0.5f / 0.201f;
  EXPECT_NEAR(plane(out, BLEND_SUM_WEIGHT, 0), first + second, 1e-4);
  EXPECT_NEAR(plane(out, BLEND_SUM_G, 0), first, 1e-4);  // only the first is white
  EXPECT_EQ(out.best[0], 0);
}

TEST(BlendRanked, with_fewer_photographs_the_worst_keeps_a_hundredth) {
  const auto out = BlendRankedCase::run(queue(), one_point({0.1f, 0.4f}, 3));
  const float first = (1 - 0.1f / 0.404f) / 0.101f, second = (1 - 1 / 1.01f) / 0.401f;
  EXPECT_NEAR(plane(out, BLEND_SUM_WEIGHT, 0), first + second, 1e-4);
}

TEST(BlendRanked, where_all_weights_vanish_the_best_stands_alone) {
  for (float penalty : {0.2f, 0.0f}) {
    const auto out = BlendRankedCase::run(queue(), one_point({penalty, penalty, penalty}, 3));
    EXPECT_EQ(plane(out, BLEND_SUM_WEIGHT, 0), 1.0f);
    EXPECT_NEAR(plane(out, BLEND_SUM_G, 0), 1, 1e-5);
    EXPECT_EQ(out.best[0], 0);
  }
}

TEST(BlendRanked, weights_sum_to_one) {
  // White photographs: whatever the weights, the mean stays white.
  auto input = BlendRankedCase::make(1009, 2);
  input.rank.blend.mix.mode = BLEND_LINEAR;
  for (auto& photo : input.rank.blend.photos)
    std::fill(photo.pixels.begin(), photo.pixels.end(), std::uint8_t{255});
  const auto out = BlendRankedCase::run(queue(), input);
  std::size_t coloured = 0;
  for (std::size_t i = 0; i < out.best.size(); ++i) {
    if (out.best[i] < 0) continue;
    ++coloured;
    EXPECT_NEAR(plane(out, BLEND_SUM_G, i) / plane(out, BLEND_SUM_WEIGHT, i), 1, 1e-5);
  }
  EXPECT_GT(coloured, 500u);
}

}  // namespace hybrid::testing
