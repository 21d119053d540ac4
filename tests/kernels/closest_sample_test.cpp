#include "cases/closest_sample_case.hpp"

#include <gtest/gtest.h>

#include "device.hpp"

namespace hybrid::testing::closest_sample_test {
namespace {

struct Agreement {
  std::size_t found = 0, equal = 0, doubtful = 0;
};

// The search in strides may end beside the closest: then what it found is farther.
Agreement agreement(const ClosestSampleCase::Input& input) {
  const auto got = ClosestSampleCase::run(queue(), input);
  const auto expected = ClosestSampleCase::reference(input);
  EXPECT_EQ(got.distance.size(), input.x.size());
  Agreement result;
  const double tolerance = ClosestSampleCase::kTolerance_m;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    if (expected.doubtful[i]) {
      ++result.doubtful;
      continue;
    }
    if (std::isnan(expected.clearance[i]))
      EXPECT_TRUE(std::isnan(got.clearance[i])) << i;
    else
      EXPECT_NEAR(got.clearance[i], expected.clearance[i], tolerance) << i;
    if (std::isnan(expected.distance[i])) {
      EXPECT_TRUE(std::isnan(got.distance[i]) && std::isnan(got.height[i]) && std::isnan(got.normal_x[i]))
          << i;
      continue;
    }
    ++result.found;
    const bool equal = std::abs(got.distance[i] - expected.distance[i]) < tolerance;
    result.equal += equal;
    if (!equal) {
      EXPECT_TRUE(expected.strided[i])
          << i << ": " << got.distance[i] << " instead of " << expected.distance[i];
      EXPECT_FALSE(got.distance[i] < expected.distance[i]) << i;
      continue;
    }
    EXPECT_NEAR(got.height[i], expected.height[i], tolerance) << i;
    EXPECT_NEAR(got.normal_x[i], expected.normal_x[i], 1e-6) << i;
    EXPECT_NEAR(got.normal_y[i], expected.normal_y[i], 1e-6) << i;
    EXPECT_NEAR(got.normal_z[i], expected.normal_z[i], 1e-6) << i;
  }
  EXPECT_LE(result.doubtful, input.x.size() / 20 + 1);
  return result;
}

bool same(const ClosestSampleCase::Output& a, const ClosestSampleCase::Output& b) {
  return same_bits(a.distance, b.distance) && same_bits(a.height, b.height) &&
         same_bits(a.normal_x, b.normal_x) && same_bits(a.normal_y, b.normal_y) &&
         same_bits(a.normal_z, b.normal_z) && same_bits(a.clearance, b.clearance);
}

// Queries turned about Z until they lie on both sides of the seam.
ClosestSampleCase::Input at_the_seam(std::size_t size) {
  auto input = ClosestSampleCase::make(size, 5);
  for (std::size_t i = 0; i < size; ++i) {
    const Vec3 p = input.grid_from_scan.inverse() * Vec3(8.5 * std::cos(0.3), 8.5 * std::sin(0.3),
                                                         0.01 * (static_cast<double>(i % 200) - 100));
    input.x[i] = static_cast<float>(p.x()), input.y[i] = static_cast<float>(p.y()),
    input.z[i] = static_cast<float>(p.z());
  }
  return input;
}

// Where few nodes have a sample, the closest one is often as far off as the gate.
ClosestSampleCase::Input with_few_samples(ClosestSampleCase::Input input) {
  for (std::size_t i = 0; i < input.px.size(); ++i)
    if (i % 7 != 0) input.px[i] = input.qx[i] = NAN;
  return input;
}

}  // namespace

TEST(ClosestSample, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto result = agreement(ClosestSampleCase::make(std::min<std::size_t>(size, 20011), 3));
    if (size > 100) {
      EXPECT_GT(result.found, size > 20011 ? 15000u : size * 3 / 4);
    }
  }
}

TEST(ClosestSample, of_a_wide_pinhole_it_looks_as_far_at_the_edges) {
  auto input = ClosestSampleCase::make(small_sizes() ? 1009 : 5003, 6, GRID_PINHOLE);
  EXPECT_GT(agreement(input).found, input.x.size() * 3 / 4);
  auto few = with_few_samples(input);
  few.gate = 0.1f;
  few.reach = 0;
  EXPECT_GT(agreement(few).found, input.x.size() / 10);
  input.gate = 1.2f;
  const auto wide = agreement(input);
  EXPECT_GT(wide.equal, wide.found * 9 / 10);
}

TEST(ClosestSample, a_wide_gate_is_searched_in_strides) {
  auto input = ClosestSampleCase::make(small_sizes() ? 127 : 5003, 4);
  input.gate = 1.2f;
  const auto result = agreement(input);
  EXPECT_GT(result.equal, result.found * 9 / 10);
}

TEST(ClosestSample, crosses_the_seam_only_where_the_grid_wraps) {
  auto input = at_the_seam(small_sizes() ? 127 : 1009);
  input.gate = 0.5f;
  EXPECT_GT(agreement(input).found, 0u);
  input.wraps = false;
  agreement(input);
}

TEST(ClosestSample, nan_queries_and_an_empty_grid_find_nothing) {
  auto input = ClosestSampleCase::make(129, 4);
  for (auto& x : input.x) x = NAN;
  for (float value : ClosestSampleCase::run(queue(), input).distance) EXPECT_TRUE(std::isnan(value));
  input = ClosestSampleCase::make(129, 4);
  for (auto& x : input.px) x = NAN;
  const auto out = ClosestSampleCase::run(queue(), input);
  for (std::size_t i = 0; i < out.distance.size(); ++i)
    EXPECT_TRUE(std::isnan(out.distance[i]) && std::isnan(out.height[i]) && std::isnan(out.clearance[i]));
}

TEST(ClosestSample, gives_the_same_bits_at_two_work_group_sizes) {
  const auto input = ClosestSampleCase::make(small_sizes() ? 1009 : 100003, 3);
  const auto [a, b] = at_two_work_group_sizes([&] { return ClosestSampleCase::run(queue(), input); });
  EXPECT_TRUE(same(a, b));
}

}  // namespace hybrid::testing::closest_sample_test
