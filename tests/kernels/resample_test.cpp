#include <gtest/gtest.h>

#include "cases/resample_case.hpp"
#include "device.hpp"

namespace hybrid::testing::resample_test {
namespace {

void expect_same(const ResampleCase::Output& a, const ResampleCase::Output& b) {
  EXPECT_TRUE(same_bits(a.range, b.range));
  EXPECT_TRUE(same_bits(a.x, b.x));
  EXPECT_TRUE(same_bits(a.y, b.y));
  EXPECT_TRUE(same_bits(a.z, b.z));
  EXPECT_EQ(a.mask, b.mask);
  EXPECT_EQ(a.pick, b.pick);
}

}  // namespace

TEST(ResampleKernel, agrees_with_its_reference_at_every_size) {
  for (const std::size_t size : kSizes) {
    const auto input = ResampleCase::make(size, 5);
    const auto got = ResampleCase::run(queue(), input);
    const auto expected = ResampleCase::reference(input);
    EXPECT_EQ(got.pick, expected.pick) << size;
    std::size_t tipped = 0, interpolated = 0;
    for (std::size_t i = 0; i < input.nodes(); ++i) {
      interpolated += expected.mask[i] == RESAMPLE_INTERPOLATED;
      if (got.mask[i] != expected.mask[i]) {
        ++tipped;
        continue;
      }
      if (got.mask[i] == RESAMPLE_EMPTY) {
        ASSERT_TRUE(std::isnan(got.range[i]) && std::isnan(got.x[i])) << i;
        continue;
      }
      const double tolerance = ResampleCase::kRelativeTolerance * expected.range[i];
      ASSERT_NEAR(got.range[i], expected.range[i], tolerance) << size << " " << i;
      ASSERT_NEAR(got.x[i], expected.x[i], tolerance) << i;
      ASSERT_NEAR(got.y[i], expected.y[i], tolerance) << i;
      ASSERT_NEAR(got.z[i], expected.z[i], tolerance) << i;
    }
    EXPECT_LE(static_cast<double>(tipped), ResampleCase::kTippedShare * static_cast<double>(input.nodes()));
    if (size > 1000) {
      EXPECT_GT(interpolated, input.nodes() / 50) << "the case must interpolate";
    }
  }
}

TEST(ResampleKernel, gives_the_same_bits_at_two_work_group_sizes) {
  const auto input = ResampleCase::make(1009, 5);
  const auto [a, b] = at_two_work_group_sizes([&] { return ResampleCase::run(queue(), input); });
  expect_same(a, b);
}

TEST(ResampleKernel, columns_without_samples_give_empty_nodes) {
  auto input = ResampleCase::make(1009, 5);
  std::fill(input.begin.begin(), input.begin.end(), 0u);
  const auto got = ResampleCase::run(queue(), input);
  for (std::size_t i = 0; i < input.nodes(); ++i) {
    ASSERT_EQ(got.mask[i], RESAMPLE_EMPTY);
    ASSERT_TRUE(std::isnan(got.range[i]));
    ASSERT_EQ(got.pick[i], RESAMPLE_NO_SAMPLE);
  }
}

// All NaN: the host never passes such samples; the kernel must still end and invent nothing.
TEST(ResampleKernel, samples_of_nan_are_never_interpolated) {
  auto input = ResampleCase::make(1009, 5);
  for (auto& sample : input.sample) sample.fill(std::numeric_limits<float>::quiet_NaN());
  const auto got = ResampleCase::run(queue(), input);
  for (std::size_t i = 0; i < input.nodes(); ++i) {
    ASSERT_NE(got.mask[i], RESAMPLE_INTERPOLATED);
    ASSERT_TRUE(std::isnan(got.range[i]));
  }
}

TEST(ResampleKernel, never_interpolates_between_a_post_and_the_wall) {
  const auto input = ResampleCase::make(100003, 5);
  const auto got = ResampleCase::run(queue(), input);
  for (std::size_t i = 0; i < input.nodes(); ++i) {
    if (got.mask[i] != RESAMPLE_INTERPOLATED) continue;
    const double horizontal = std::hypot(got.x[i], got.y[i]);
    ASSERT_TRUE(std::abs(horizontal - 3) < 0.02 || std::abs(horizontal - 4) < 0.02) << horizontal;
  }
}

}  // namespace hybrid::testing::resample_test
