#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cases/ray_cast_case.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(RayCast, agrees_with_its_reference_at_every_size) {
  for (std::size_t size : kSizes) {
    const auto input = RayCastCase::make(size, 3);
    const auto got = RayCastCase::run(queue(), input);
    const auto expected = RayCastCase::reference(input);
    std::size_t wrong = 0, hits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      wrong += !RayCastCase::agrees(got, expected, i);
      hits += expected.id[i] != 0;
    }
    EXPECT_LE(static_cast<double>(wrong), RayCastCase::kUndecided * static_cast<double>(size)) << size;
    if (size > 1000) {
      EXPECT_GT(static_cast<double>(hits), 0.3 * static_cast<double>(size));
    }
  }
}

TEST(RayCast, gives_the_same_bits_at_two_work_group_sizes_and_every_vector_width) {
  const auto [a, b] =
      at_two_work_group_sizes([] { return RayCastCase::run(queue(), RayCastCase::make(1009, 5)); });
  EXPECT_TRUE(same_bits(a.distance, b.distance));
  EXPECT_TRUE(same_bits(a.surface, b.surface));
  EXPECT_EQ(a.id, b.id);
  for (int width : vector_widths()) {
    auto input = RayCastCase::make(1009, 5);
    input.vector_width = width;
    const auto other = RayCastCase::run(queue(), input);
    EXPECT_TRUE(same_bits(a.distance, other.distance)) << width;
    EXPECT_TRUE(same_bits(a.surface, other.surface)) << width;
    EXPECT_EQ(a.id, other.id) << width;
  }
}

TEST(RayCast, rays_of_several_origins_hit_what_those_of_each_alone_hit) {
  constexpr std::size_t kEach = 48, kGroups = 5;
  auto all = RayCastCase::make(kEach * kGroups, 7);
  for (std::size_t group = 0; group < kGroups; ++group)
    all.origins.insert(all.origins.end(), {0.4f * static_cast<float>(group), -0.3f, 0.7f});
  for (int width : vector_widths()) {
    all.vector_width = width;
    const auto together = RayCastCase::run(queue(), all);
    for (std::size_t group = 0; group < kGroups; ++group) {
      auto alone = all;
      alone.origins.clear();
      std::copy_n(all.origins.begin() + static_cast<std::ptrdiff_t>(3 * group), 3, alone.origin.begin());
      const auto begin = all.directions.begin() + static_cast<std::ptrdiff_t>(3 * kEach * group);
      alone.directions.assign(begin, begin + 3 * kEach);
      const auto expected = RayCastCase::run(queue(), alone);
      std::vector<float> distance, x;
      std::vector<std::uint32_t> id;
      for (std::size_t i = kEach * group; i < kEach * (group + 1); ++i) {
        distance.push_back(together.distance[i]);
        id.push_back(together.id[i]);
        x.push_back(together.surface[i]);
      }
      EXPECT_TRUE(same_bits(distance, expected.distance)) << group;
      EXPECT_EQ(id, expected.id) << group;
      EXPECT_TRUE(same_bits(x, {expected.surface.begin(), expected.surface.begin() + kEach})) << group;
    }
  }
}

TEST(RayCast, rays_without_a_direction_and_empty_scenes_hit_nothing) {
  auto input = RayCastCase::make(129, 1);
  const auto full = input.directions;
  std::fill(input.directions.begin(), input.directions.end(), std::numeric_limits<float>::quiet_NaN());
  auto check = [](const RayCastCase::Output& out) {
    for (std::size_t i = 0; i < out.id.size(); ++i) {
      EXPECT_EQ(out.id[i], 0u);
      EXPECT_TRUE(std::isinf(out.distance[i]) && std::isnan(out.surface[i]));
    }
  };
  check(RayCastCase::run(queue(), input));
  input.directions = full;
  input.scene = {};
  check(RayCastCase::run(queue(), input));
}

TEST(RayCast, no_ray_slips_through_a_shared_edge_or_vertex) {
  // A fan of thin triangles around the axis; rays aimed exactly at its edges and at its hub.
  auto input = RayCastCase::make(0, 1);
  input.scene = {};
  input.origin = {0.1f, 0.2f, -3.7f};
  const int spokes = 37;
  const auto rim = [&](int i, float scale) {
    const double angle = 2 * std::numbers::pi * (i % spokes) / spokes;
    return std::array<float, 3>{scale * static_cast<float>(std::cos(angle)),
                                scale * static_cast<float>(std::sin(angle)), 0};
  };
  for (int i = 0; i < spokes; ++i) {
    TriangleRecord t{};
    const auto b = rim(i, 5), c = rim(i + 1, 5);
    std::copy(b.begin(), b.end(), t.b);
    std::copy(c.begin(), c.end(), t.c);
    t.id = 1;
    input.scene.triangles.push_back(t);
    for (float s = 0; s < 0.99f; s += 0.01f) {
      const auto at = rim(i, 5 * s);
      const Vec3f d =
          Vec3f(at[0] - input.origin[0], at[1] - input.origin[1], at[2] - input.origin[2]).normalized();
      input.directions.insert(input.directions.end(), {d.x(), d.y(), d.z()});
    }
  }
  const auto out = RayCastCase::run(queue(), input);
  EXPECT_EQ(std::count(out.id.begin(), out.id.end(), 1u), static_cast<std::ptrdiff_t>(out.id.size()));
}

TEST(RayCast, a_sphere_within_the_tolerance_behind_a_face_wins_and_a_farther_one_does_not) {
  auto input = RayCastCase::make(0, 1);
  input.origin = {0, 0, 0};
  input.directions = {0, 0, 1};
  input.tolerance_m = 0.02f;
  TriangleRecord wall{};
  wall.a[0] = -9, wall.a[1] = -9, wall.b[0] = 9, wall.b[1] = -9, wall.c[1] = 9;
  wall.a[2] = wall.b[2] = wall.c[2] = 4;
  wall.id = 7;
  for (const auto& [depth, expected] :
       {std::pair(4.015f, 0x80000000u), std::pair(4.03f, 7u), std::pair(3.5f, 0x80000000u)}) {
    input.scene = {};
    input.scene.triangles.push_back(wall);
    input.scene.spheres.push_back({{0, 0, depth}, 0.01f});
    input.scene.surfaces.push_back({{0, 0, -1}, 0x80000000u});
    const auto out = RayCastCase::run(queue(), input);
    EXPECT_EQ(out.id[0], expected) << depth;
    const float hit = expected == 7u ? 4.0f : depth;  // on the patch, not on the bulge
    EXPECT_NEAR(out.distance[0], hit, 1e-6f) << depth;
  }
}

TEST(RayCast, camera_rays_meet_the_surface_where_the_camera_sees_it) {
  // A distorted camera before a wall: every hit projects back to the pixel its ray came from.
  Photograph view = look_at({0.4, -3, 0.2}, {0, 0, 0}, {0, 0, 1}, 60, 67, 45);
  view.camera.k1 = -0.25, view.camera.k2 = 0.06, view.camera.p1 = 0.01, view.camera.p2 = -0.02;
  TriangleRecord wall{};
  wall.a[0] = -90, wall.a[2] = -90, wall.b[0] = 90, wall.b[2] = -90, wall.c[2] = 150;
  wall.id = 1;
  const auto bvh = stages::upload_bvh(queue(), stages::build_bvh({wall}, {}), {});
  stages::SurfaceTile tile(queue(), 20 * 30);
  stages::cast_tile(queue(), bvh, stages::camera_record(view, Vec3::Zero()), {11, 17, 20, 30}, {0.25f, 0.5f},
                    0, tile);
  const auto surface = queue().read(tile.surface);
  for (std::size_t i = 0; i < 600; ++i) {
    const Vec3 point(surface[i], surface[600 + i], surface[1200 + i]);
    const auto pixel = view.camera.project(view.cam_from_world * point);
    ASSERT_TRUE(pixel) << i;
    // Float rays from 3 m, f = 39 px: 1e-5 px; far below anything a photograph resolves.
    EXPECT_NEAR(pixel->x(), 17 + static_cast<double>(i % 30) + 0.25, 2e-3);
    EXPECT_NEAR(pixel->y(), 11 + static_cast<double>(i / 30) + 0.5, 2e-3);
  }
}

TEST(RayCast, pixels_beyond_the_fold_of_the_distortion_have_no_ray) {
  Photograph view = look_at({0, -3, 0}, {0, 0, 0}, {0, 0, 1}, 120, 64, 64);
  view.camera.k1 = -0.4;  // folds back at r = 0.91, radius 0.61; the corners of the image lie at 2.4
  TriangleRecord wall{};
  wall.a[0] = -90, wall.a[2] = -90, wall.b[0] = 90, wall.b[2] = -90, wall.c[2] = 150;
  wall.id = 1;
  const auto bvh = stages::upload_bvh(queue(), stages::build_bvh({wall}, {}), {});
  const auto map = stages::cast_distances(queue(), bvh, stages::camera_record(view, Vec3::Zero()), 0);
  const auto id = queue().read(map.id);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double radius = std::hypot((x + 0.5 - 32) / view.camera.fx, (y + 0.5 - 32) / view.camera.fy);
      if (std::abs(radius - 0.6086) < 0.02) continue;  // the fold itself
      EXPECT_EQ(id[static_cast<std::size_t>(y * 64 + x)], radius < 0.6086 ? 1u : 0u) << x << " " << y;
    }
}

}  // namespace hybrid::testing
