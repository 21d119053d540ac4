#include "cases/closest_sample_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

// Queries of another place: before the walls and behind them, so that blocks tell that none is near, but for
// some; on both sides of the seam, too.
TEST(ClosestSample, far_from_all_samples_it_finds_what_is_near_and_how_far_it_sees) {
  for (const std::uint32_t lens : {GRID_SPHERICAL, GRID_PINHOLE}) {
    auto input = ClosestSampleCase::make(small_sizes() ? 509 : 5003, 8, lens);
    for (std::size_t i = 0; i < input.x.size(); ++i) {
      const double factor = i % 4 == 0 ? 1 : 0.45 + 0.15 * static_cast<double>(i % 8);
      const Vec3 p = input.grid_from_scan * Vec3(input.x[i], input.y[i], input.z[i]);
      const Vec3 moved = input.grid_from_scan.inverse() * (factor * p);
      input.x[i] = static_cast<float>(moved.x()), input.y[i] = static_cast<float>(moved.y()),
      input.z[i] = static_cast<float>(moved.z());
    }
    input.reach = 0;
    for (const float gate : {0.05f, 0.15f, 0.6f}) {
      input.gate = gate;
      const auto result = agreement(input);
      EXPECT_GT(result.found, input.x.size() / 40) << gate;
      EXPECT_LT(result.found, input.x.size() * 2 / 3) << gate;
    }
  }
}

TEST(ClosestSample, several_places_at_once_are_the_same_as_one_by_one) {
  auto input = ClosestSampleCase::make(small_sizes() ? 127 : 5003, 7);
  const std::size_t count = input.x.size();
  for (int k = 1; k < CLOSEST_SAMPLE_PLACES; ++k) {
    Pose place = input.grid_from_scan;
    place.translation += 0.05 * k * Vec3(1, -1, 0.5);
    input.more_places.push_back(place);
  }
  const auto together = ClosestSampleCase::run(queue(), input);
  ASSERT_EQ(together.height.size(), count * CLOSEST_SAMPLE_PLACES);
  for (std::size_t k = 0; k < CLOSEST_SAMPLE_PLACES; ++k) {
    auto one = input;
    if (k > 0) one.grid_from_scan = input.more_places[k - 1];
    one.more_places.clear();
    const auto alone = ClosestSampleCase::run(queue(), one);
    const auto part = [&](const std::vector<float>& all) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(k * count);
      return std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    EXPECT_TRUE(same({part(together.distance),
                      part(together.height),
                      part(together.normal_x),
                      part(together.normal_y),
                      part(together.normal_z),
                      part(together.clearance),
                      {},
                      {}},
                     alone))
        << k;
  }
}

// Whatever the steps, an edge is among those of its bin.
TEST(ClosestSample, bins_hold_all_edges) {
  std::vector<float> uneven, with_gap;
  for (int k = 0; k < 400; ++k) uneven.push_back(-1 + 2e-5f * static_cast<float>(k * k));
  for (int k = 0; k < 400; ++k) with_gap.push_back(k < 399 ? 1e-4f * static_cast<float>(k) : 100.0f);
  const std::vector<float> lone = {0.5f}, equal(40, 0.25f);
  for (const auto& edges : {uneven, with_gap, lone, equal}) {
    const auto bins = stages::edge_bins(edges, 1);
    ASSERT_EQ(bins.starts.size(), static_cast<std::size_t>(GRID_BINS + 1));
    EXPECT_EQ(bins.starts.front(), 0u);
    EXPECT_EQ(bins.starts.back(), edges.size());
    EXPECT_TRUE(std::is_sorted(bins.starts.begin(), bins.starts.end()));
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const float at = std::clamp((edges[k] - edges[0]) * bins.per_unit, 0.0f, GRID_BINS - 1.0f);
      const auto bin = static_cast<std::size_t>(at);
      EXPECT_LE(bins.starts[bin], k);
      EXPECT_GT(bins.starts[bin + 1], k);
    }
  }
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
