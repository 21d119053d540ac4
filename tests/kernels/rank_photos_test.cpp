#include <gtest/gtest.h>

#include <algorithm>

#include "cases/rank_photos_case.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(RankPhotos, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes)
    for (std::uint32_t kept : {2u, 5u}) {
      if (size > 2000 && kept != 2) continue;
      auto input = RankPhotosCase::make(size, 4);
      input.kept = kept;
      const auto got = RankPhotosCase::run(queue(), input);
      const auto expected = RankPhotosCase::reference(input);
      std::size_t wrong = 0, full = 0;
      for (std::size_t i = 0; i < input.blend.count(); ++i) {
        wrong += !RankPhotosCase::agrees(got, expected, i);
        full += expected.seen[i] > kept;
      }
      EXPECT_LE(static_cast<double>(wrong), RankPhotosCase::kUndecided * static_cast<double>(size)) << size;
      if (size > 1000 && kept == 2) {
        EXPECT_GT(full, size / 10);  // points where a photograph had to be displaced
      }
    }
}

TEST(RankPhotos, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  auto input = RankPhotosCase::make(1009, 5);
  const auto [a, b] = at_two_work_group_sizes([&] { return RankPhotosCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a.penalty, b.penalty));
  EXPECT_EQ(a.photo, b.photo);
  EXPECT_EQ(a.seen, b.seen);
  for (int width : vector_widths()) {
    input.blend.vector_width = width;
    const auto other = RankPhotosCase::run(queue(), input);
    EXPECT_TRUE(same_bits(a.penalty, other.penalty)) << width;
    EXPECT_EQ(a.photo, other.photo) << width;
  }
}

TEST(RankPhotos, no_surface_is_ranked_for_nothing) {
  auto input = RankPhotosCase::make(129, 1);
  std::fill(input.blend.surface.begin(), input.blend.surface.end(), std::numeric_limits<float>::quiet_NaN());
  const auto out = RankPhotosCase::run(queue(), input);
  EXPECT_EQ(std::count(out.seen.begin(), out.seen.end(), 0u), 129);
  EXPECT_EQ(std::count(out.photo.begin(), out.photo.end(), -1), 3 * 129);
}

TEST(RankPhotos, among_equal_photographs_the_smaller_index_stays) {
  auto input = RankPhotosCase::make(1009, 2);
  for (auto& photo : input.blend.photos) photo = input.blend.photos[0];
  const auto out = RankPhotosCase::run(queue(), input);
  for (std::size_t i = 0; i < out.seen.size(); ++i)
    for (std::size_t r = 0; r < 3; ++r)
      ASSERT_EQ(out.photo[r * out.seen.size() + i], out.seen[i] ? static_cast<int>(r) : -1) << i;
}

}  // namespace hybrid::testing
