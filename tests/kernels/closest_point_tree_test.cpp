#include <gtest/gtest.h>

#include "cases/closest_point_tree_case.hpp"
#include "device.hpp"
#include "stages/registration/proxy_model.hpp"

namespace hybrid::testing::closest_point_tree_test {
namespace {

using Case = ClosestPointTreeCase;

bool same(const Case::Output& a, const Case::Output& b) {
  return same_bits(a.distance, b.distance) && same_bits(a.height, b.height) &&
         same_bits(a.triangle, b.triangle) && same_bits(a.near_x, b.near_x) &&
         same_bits(a.near_y, b.near_y) && same_bits(a.near_z, b.near_z);
}

stages::ProxyTree tree_of(const Case::Input& in) {
  return stages::make_proxy_tree(stages::proxy_triangles(in.model, in.origin));
}

// Same bytes as brute force over the same triangles, of which `found` at least have a closest point.
void expect_brute_force(const Case::Input& in, std::size_t found, const stages::ProxyTree& tree) {
  const auto got = Case::run(queue(), in, tree), expected = Case::brute_force(queue(), in, tree);
  EXPECT_TRUE(same(got, expected)) << in.model.faces.size() << " faces, " << in.x.size() << " queries, gate "
                                   << in.gate_m << ", " << in.normal_deg << " degrees";
  std::size_t count = 0;
  for (const auto triangle : got.triangle) count += triangle != NO_TRIANGLE;
  EXPECT_GE(count, found);
}
void expect_brute_force(const Case::Input& in, std::size_t found) {
  expect_brute_force(in, found, tree_of(in));
}

}  // namespace

TEST(ClosestPointTree, agrees_with_its_reference) {
  // The reference looks at every triangle in double: few queries.
  for (std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{129}, std::size_t{1009}}) {
    if (small_sizes() && size > 129) continue;
    const auto input = Case::make(size, 3, 2);
    const auto got = Case::run(queue(), input);
    const auto expected = Case::reference(input);
    ASSERT_EQ(got.distance.size(), size);
    for (std::size_t i = 0; i < size; ++i) {
      if (expected.doubtful[i]) continue;
      ASSERT_EQ(got.triangle[i] == NO_TRIANGLE, expected.triangle[i] == NO_TRIANGLE) << i;
      if (got.triangle[i] == NO_TRIANGLE) continue;
      ASSERT_NEAR(got.distance[i], expected.distance[i], Case::kTolerance) << i;
    }
  }
}

TEST(ClosestPointTree, gives_brute_force_s_bytes_at_every_size) {
  for (std::size_t size : kSizes) expect_brute_force(Case::make(size, 3), size > 100 ? size / 2 : 0);
}

TEST(ClosestPointTree, gives_brute_force_s_bytes_about_every_origin_in_the_order_of_one_tree) {
  const std::size_t size = small_sizes() ? 101 : 5003;
  auto input = Case::make(size, 6);
  const stages::ProxyModel model(input.model);
  const Vec3 made = input.origin;
  std::vector<std::uint32_t> faces;
  for (const Vec3& moved : {Vec3(0, 0, 0), Vec3(3, -2, 1), Vec3(-400, 700, 50)}) {
    input.origin = made + moved;
    input.local_from_scan.translation -= moved;
    const stages::ProxyTree tree = model.tree_at(input.origin);
    ASSERT_NE(tree.root, BVH_EMPTY);
    expect_brute_force(input, size / 2, tree);
    input.local_from_scan.translation += moved;
    std::vector<std::uint32_t> order;
    for (const auto& triangle : tree.triangles) order.push_back(triangle.face);
    if (faces.empty()) faces = order;
    EXPECT_EQ(order, faces);
  }
}

TEST(ClosestPointTree, gives_brute_force_s_bytes_gated_unoriented_scaled_and_far_away) {
  const std::size_t size = small_sizes() ? 101 : 5003;
  auto input = Case::make(size, 5);
  input.gate_m = 0.05f;
  expect_brute_force(input, small_sizes() ? 10 : 1000);
  input.normal_deg = 180;
  expect_brute_force(input, small_sizes() ? 10 : 1000);
  input.gate_m = INFINITY;
  input.local_from_scan.scale = 1.3;
  input.normal_deg = 30;
  expect_brute_force(input, small_sizes() ? 60 : 4000);
  // Queries that are nowhere near a face, whose distances differ by roundings.
  input.local_from_scan.translation = Vec3(300, -200, 80);
  expect_brute_force(input, small_sizes() ? 60 : 4000);
}

TEST(ClosestPointTree, gives_brute_force_s_bytes_on_190_000_faces) {
  // Where every memory access is checked, 6,480 of them: brute force looks at each.
  if (small_sizes())
    expect_brute_force(Case::make(129, 7, 6), 100);
  else
    expect_brute_force(Case::make(1009, 7, 33), 900);
}

// A face of 200 slivers whose corners are off its plane within the tolerance of a planar face, and needles.
TEST(ClosestPointTree, gives_brute_force_s_bytes_on_slivers) {
  const std::size_t size = small_sizes() ? 101 : 5003;
  auto input = ClosestPointCase::make(size, 9);
  Face fan;
  fan.name = "fan";
  for (int i = 0; i <= 200; ++i) {
    const double at = 6.2 * i / 200.0;
    fan.outer.push_back(static_cast<std::uint32_t>(input.model.vertices.size()));
    input.model.vertices.push_back(input.origin + Vec3(5 * std::cos(at), 5 * std::sin(at), 1e-4 * (i % 3)));
  }
  input.model.faces.push_back(fan);
  for (int i = 0; i < 50; ++i) {
    Face needle;
    needle.name = "needle-" + std::to_string(i);
    for (const Vec3& corner :
         {Vec3(-6, i * 0.01, 0), Vec3(6, i * 0.01, 0.3), Vec3(6, i * 0.01 + 2e-3, 0.3)}) {
      needle.outer.push_back(static_cast<std::uint32_t>(input.model.vertices.size()));
      input.model.vertices.push_back(input.origin + corner);
    }
    input.model.faces.push_back(needle);
  }
  expect_brute_force(input, small_sizes() ? 60 : 4000);
  input.normal_deg = 180;
  expect_brute_force(input, small_sizes() ? 60 : 4000);
}

TEST(ClosestPointTree, gives_the_same_bits_at_two_work_group_sizes_and_every_number_of_lanes) {
  auto input = Case::make(small_sizes() ? 129 : 10007, 3);
  const auto tree = tree_of(input);
  const auto [a, b] = at_two_work_group_sizes([&] { return Case::run(queue(), input, tree); });
  EXPECT_TRUE(same(a, b));
  for (int lanes : vector_widths()) {
    input.lanes = lanes;
    EXPECT_TRUE(same(a, Case::run(queue(), input, tree))) << lanes;
  }
}

TEST(ClosestPointTree, all_nan_gives_no_answers) {
  auto input = Case::make(129, 3);
  for (auto& value : input.x) value = NAN;
  for (std::uint32_t t : Case::run(queue(), input).triangle) EXPECT_EQ(t, NO_TRIANGLE);
}

}  // namespace hybrid::testing::closest_point_tree_test
