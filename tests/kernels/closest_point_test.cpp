#include <gtest/gtest.h>

#include "cases/closest_point_case.hpp"
#include "device.hpp"

namespace hybrid::testing::closest_point_test {
namespace {

// Which of several equally near triangles is found is up to rounding, so the triangle is judged by its
// distance, and height and closest point by the triangle.
void expect_agreement(const ClosestPointCase::Input& input) {
  const auto got = ClosestPointCase::run(queue(), input);
  const auto expected = ClosestPointCase::reference(input);
  const auto triangles = triangulate(input.model);
  const auto records = stages::proxy_triangles(input.model, input.origin);
  ASSERT_EQ(got.distance.size(), input.x.size());
  const double tolerance = ClosestPointCase::kTolerance;
  std::size_t found = 0, doubtful = 0;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    doubtful += static_cast<std::size_t>(expected.doubtful[i]);
    if (expected.doubtful[i] || std::abs(expected.distance[i] - input.gate_m) < tolerance) continue;
    if (expected.triangle[i] == NO_TRIANGLE) {
      if (got.triangle[i] != NO_TRIANGLE) {  // only what the gate's rounding lets in
        ASSERT_NEAR(got.distance[i], input.gate_m, tolerance) << i;
        continue;
      }
      ASSERT_TRUE(std::isnan(got.distance[i]) && std::isnan(got.height[i]) && std::isnan(got.near_x[i])) << i;
      continue;
    }
    ++found;
    ASSERT_NEAR(got.distance[i], expected.distance[i], tolerance) << i;
    ASSERT_LT(got.triangle[i], triangles.size()) << i;
    const Vec3 p = input.local_from_scan * Vec3(input.x[i], input.y[i], input.z[i]);
    ASSERT_NEAR(ClosestPointCase::distance_to(input, triangles[got.triangle[i]], p), expected.distance[i],
                tolerance)
        << i;
    const Vec3 near(got.near_x[i], got.near_y[i], got.near_z[i]);
    ASSERT_NEAR((p - near).norm(), expected.distance[i], tolerance) << i;
    ASSERT_NEAR(ClosestPointCase::distance_to(input, triangles[got.triangle[i]], near), 0, tolerance) << i;
    const auto& r = records[got.triangle[i]];
    ASSERT_NEAR(got.height[i], p.dot(Vec3(r.normal[0], r.normal[1], r.normal[2])) - r.offset, tolerance) << i;
  }
  EXPECT_LE(doubtful, input.x.size() / 100 + 1);
  if (input.x.size() > 100) {
    EXPECT_GT(found, 0u);
  }
}

bool same(const ClosestPointCase::Output& a, const ClosestPointCase::Output& b) {
  return same_bits(a.distance, b.distance) && same_bits(a.height, b.height) &&
         same_bits(a.triangle, b.triangle) && same_bits(a.near_x, b.near_x) &&
         same_bits(a.near_y, b.near_y) && same_bits(a.near_z, b.near_z);
}

}  // namespace

TEST(ClosestPoint, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) expect_agreement(ClosestPointCase::make(size, 3));
}

TEST(ClosestPoint, agrees_with_its_reference_gated_unoriented_and_scaled) {
  auto input = ClosestPointCase::make(small_sizes() ? 503 : 5003, 5);
  input.gate_m = 0.05f;
  expect_agreement(input);
  input.normal_deg = 180;
  expect_agreement(input);
  input.gate_m = INFINITY;
  input.local_from_scan.scale = 1.3;
  input.normal_deg = 30;
  expect_agreement(input);
}

TEST(ClosestPoint, gives_the_same_bits_at_two_work_group_sizes_and_every_number_of_lanes) {
  auto input = ClosestPointCase::make(small_sizes() ? 509 : 10007, 3);
  const auto [a, b] = at_two_work_group_sizes([&] { return ClosestPointCase::run(queue(), input); });
  EXPECT_TRUE(same(a, b));
  for (int lanes : vector_widths()) {
    input.lanes = lanes;
    EXPECT_TRUE(same(a, ClosestPointCase::run(queue(), input))) << lanes;
  }
}

TEST(ClosestPoint, a_query_s_result_does_not_depend_on_its_neighbours) {
  const auto input = ClosestPointCase::make(small_sizes() ? 401 : 4001, 3);
  const auto all = ClosestPointCase::run(queue(), input);
  auto every_third = input;
  for (auto* values :
       {&every_third.x, &every_third.y, &every_third.z, &every_third.nx, &every_third.ny, &every_third.nz})
    for (std::size_t i = 0; i < values->size(); ++i)
      if (i % 3) (*values)[i] = NAN;
  const auto some = ClosestPointCase::run(queue(), every_third);
  for (std::size_t i = 0; i < input.x.size(); i += 3) {
    ASSERT_EQ(all.triangle[i], some.triangle[i]);
    ASSERT_EQ(std::memcmp(&all.distance[i], &some.distance[i], 4), 0);
  }
}

TEST(ClosestPoint, all_nan_gives_no_answers) {
  auto input = ClosestPointCase::make(129, 3);
  for (auto& value : input.x) value = NAN;
  for (std::uint32_t t : ClosestPointCase::run(queue(), input).triangle) EXPECT_EQ(t, NO_TRIANGLE);
}

}  // namespace hybrid::testing::closest_point_test
