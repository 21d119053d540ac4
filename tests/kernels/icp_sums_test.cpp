#include <gtest/gtest.h>

#include "cases/icp_sums_case.hpp"
#include "device.hpp"

namespace hybrid::testing::icp_sums_test {
namespace {

void expect_agreement(const IcpSumsCase::Input& input) {
  const auto got = IcpSumsCase::run(queue(), input);
  const auto expected = IcpSumsCase::reference(input);
  ASSERT_EQ(got.partial.size(), expected.partial.size());
  const auto width = static_cast<std::size_t>(input.sums());
  for (std::size_t k = 0; k < got.partial.size(); ++k) {
    ASSERT_NEAR(got.partial[k], expected.partial[k], IcpSumsCase::kTolerance * expected.magnitude[k])
        << "block " << k / width << " sum " << k % width << " of " << input.x.size() << " samples";
  }
}

}  // namespace

TEST(IcpSums, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    expect_agreement(IcpSumsCase::make(size, 3));
    expect_agreement(IcpSumsPointCase::make(size, 3));
    expect_agreement(IcpSumsNormalsCase::make(size, 3));
  }
}

TEST(IcpSums, without_a_cutoff_every_pair_counts_its_area) {
  auto input = IcpSumsCase::make(1009, 4);
  input.cutoff = INFINITY;
  expect_agreement(input);
  input.point = true;
  expect_agreement(input);
}

TEST(IcpSums, given_normals_give_the_same_at_every_width) {
  auto input = IcpSumsNormalsCase::make(1009, 3);
  for (int width : vector_widths()) {
    input.lanes = width;
    expect_agreement(input);
  }
}

TEST(IcpSums, all_nan_adds_up_to_zero) {
  for (bool point : {false, true}) {
    auto input = IcpSumsCase::make(300, 4);
    input.point = point;
    for (auto& error : input.error) error = NAN;
    for (double value : IcpSumsCase::run(queue(), input).partial) EXPECT_EQ(value, 0);
  }
}

TEST(IcpSums, gives_the_same_bits_at_two_work_group_sizes) {
  for (bool point : {false, true}) {
    auto input = IcpSumsCase::make(small_sizes() ? 10007 : 100003, 3);
    input.point = point;
    const auto [a, b] = at_two_work_group_sizes([&] { return IcpSumsCase::run(queue(), input); });
    EXPECT_TRUE(same_bits(a.partial, b.partial));
  }
}

}  // namespace hybrid::testing::icp_sums_test
