#include <gtest/gtest.h>

#include "cases/square_planes_case.hpp"
#include "device.hpp"
#include "geometry/vectors.hpp"

namespace hybrid::testing {
namespace {

using Input = SquarePlanesCase::Input;

void expect_as_reference(const Input& input) {
  const auto got = SquarePlanesCase::run(queue(), input);
  const auto expected = SquarePlanesCase::reference(input);
  ASSERT_EQ(got.size(), expected.size());
  std::size_t others = 0, planar = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const SquareRecord &a = got[i], &b = expected[i];
    ASSERT_EQ(a.valid, b.valid) << i;
    if (a.state != b.state || a.inliers != b.inliers ||
        std::abs(a.rms - b.rms) > SquarePlanesCase::kDistanceM) {
      ++others;
      continue;
    }
    if (a.state != SQUARE_PLANAR) {
      SquareRecord zero{};
      zero.valid = a.valid;
      zero.state = a.state;
      ASSERT_EQ(std::memcmp(&a, &zero, sizeof a), 0) << i;
      continue;
    }
    ++planar;
    const Eigen::Map<const Vec3f> normal(a.normal), expected_normal(b.normal), centroid(a.centroid),
        expected_centroid(b.centroid);
    ASSERT_LT(normal.cross(expected_normal).norm(), SquarePlanesCase::kAngleRad) << i;
    ASSERT_GT(normal.dot(expected_normal), 0) << i;
    ASSERT_LT((centroid - expected_centroid).norm(), SquarePlanesCase::kDistanceM) << i;
    const double at_centroid = normal.cast<double>().dot(expected_centroid.cast<double>()) - a.offset;
    const double expected_at =
        expected_normal.cast<double>().dot(expected_centroid.cast<double>()) - b.offset;
    ASSERT_NEAR(at_centroid, expected_at, SquarePlanesCase::kDistanceM) << i;
    for (int k = 0; k < 6; ++k)
      ASSERT_NEAR(a.scatter[k], b.scatter[k], 1e-5 * (b.scatter[0] + b.scatter[3] + b.scatter[5])) << i;
    ASSERT_NEAR(a.sigma_normal, b.sigma_normal, 0.01 * b.sigma_normal) << i;
  }
  EXPECT_LE(static_cast<double>(others),
            0.5 + SquarePlanesCase::kOtherShare * static_cast<double>(got.size()));
  if (got.size() > 100) {
    EXPECT_GT(planar, got.size() / 10) << "the case must hold planar squares";
  }
}

}  // namespace

TEST(SquarePlanesKernel, agrees_with_its_reference_at_every_size) {
  for (const std::size_t size : kSizes) {
    SCOPED_TRACE(size);
    expect_as_reference(SquarePlanesCase::make(size, 2));
  }
}

TEST(SquarePlanesKernel, agrees_with_its_reference_for_every_score_fit_and_side) {
  const std::size_t count = small_sizes() ? 2011 : 20011;
  for (const int side : {3, 4, 7, 16}) {
    SCOPED_TRACE(side);
    expect_as_reference(SquarePlanesCase::make(count, 2, side));
  }
  auto paper = SquarePlanesCase::make(count, 2);
  paper.params.score = SQUARE_SCORE_PAPER;
  expect_as_reference(paper);
  auto eigen = SquarePlanesCase::make(count, 2);
  eigen.params.fit = SQUARE_FIT_EIGEN;
  expect_as_reference(eigen);
  auto odd = SquarePlanesCase::make(count, 2);
  odd.params.hypotheses = 7;
  odd.params.first_square_row = 160;
  odd.params.first_square_col = 48;
  expect_as_reference(odd);
}

TEST(SquarePlanesKernel, gives_the_same_bits_at_two_work_group_sizes) {
  const auto input = SquarePlanesCase::make(small_sizes() ? 1009 : 10007, 2);
  const auto [a, b] = at_two_work_group_sizes([&] { return SquarePlanesCase::run(queue(), input); });
  EXPECT_TRUE(same_bits(a, b));
}

TEST(SquarePlanesKernel, gives_the_same_bits_at_every_vector_width) {
  auto input = SquarePlanesCase::make(small_sizes() ? 1009 : 10007, 2);
  input.vector_width = 1;
  const auto scalar = SquarePlanesCase::run(queue(), input);
  for (const int width : vector_widths()) {
    input.vector_width = width;
    EXPECT_TRUE(same_bits(SquarePlanesCase::run(queue(), input), scalar)) << width;
  }
}

TEST(SquarePlanesKernel, squares_without_samples_are_undersampled) {
  auto input = SquarePlanesCase::make(1009, 2);
  for (auto* values : {&input.x, &input.y, &input.z})
    std::fill(values->begin(), values->end(), std::numeric_limits<float>::quiet_NaN());
  for (const SquareRecord& record : SquarePlanesCase::run(queue(), input)) {
    const SquareRecord zero{};
    ASSERT_EQ(std::memcmp(&record, &zero, sizeof record), 0);
  }
}

TEST(SquarePlanesKernel, one_plane_without_noise_is_found_everywhere) {
  auto input = SquarePlanesCase::make(10000, 2);
  for (std::size_t i = 0; i < input.x.size(); ++i) {  // x = 5 seen at 1 mrad
    input.x[i] = 5;
    input.y[i] = 5 * std::tan(0.001f * static_cast<float>(i % 100));
    input.z[i] = -5 * std::tan(0.001f * static_cast<float>(i / 100));
  }
  for (const SquareRecord& record : SquarePlanesCase::run(queue(), input)) {
    ASSERT_EQ(record.state, SQUARE_PLANAR);
    ASSERT_EQ(record.inliers, 25u);
    ASSERT_LT(record.normal[0], -0.999999f);
    ASSERT_NEAR(record.offset, -5, 1e-4);
  }
}

}  // namespace hybrid::testing
