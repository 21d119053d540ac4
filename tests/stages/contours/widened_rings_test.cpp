#include "stages/contours/widened_rings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hybrid::testing::widened_rings_test {
namespace {

constexpr double kStep_rad = 0.01, kWall_m = 2;

// A scanner at the origin that looks along x at a wall, 2 m away.
struct Wall {
  RangeImage image = make_range_image(41, 41);
  Supercluster wall;

  Wall() {
    for (int k = 0; k < 41; ++k) {
      image.elevation_rad[static_cast<std::size_t>(k)] = (20 - k) * kStep_rad;
      image.azimuth_rad[static_cast<std::size_t>(k)] = (k - 20) * kStep_rad;
    }
    wall.id = 7;
    wall.plane = {{-1, 0, 0}, -kWall_m};
  }

  // Counter-clockwise as the scanner sees it for an outer one; (y, z) in metres.
  stages::FlatRing ring(const std::vector<std::array<double, 2>>& corners, bool outer = true) const {
    const stages::PlaneCoordinates coordinates(wall.plane);
    stages::FlatRing result{{}, outer};
    for (const auto& [y, z] : corners) result.vertices.push_back(coordinates.vertex({kWall_m, y, z}));
    if ((stages::signed_area2(result) > 0) != outer)
      std::reverse(result.vertices.begin(), result.vertices.end());
    return result;
  }
  std::vector<stages::FlatRing> widened(const std::vector<stages::FlatRing>& rings,
                                        const std::vector<stages::Intersection>& lines = {}) const {
    return stages::widened_rings(image, wall, lines, 0.5, rings);
  }
};

Eigen::AlignedBox2d box(const stages::FlatRing& ring) {
  Eigen::AlignedBox2d result;
  for (const auto& vertex : ring.vertices) result.extend(Vec2(vertex.point.y(), vertex.point.z()));
  return result;
}

constexpr double kHalf_m = 0.5 * kStep_rad * kWall_m;  // of a step, straight ahead

}  // namespace

TEST(WidenedRings, sides_go_half_a_step_out_and_holes_in) {
  const Wall scan;
  const auto rings =
      scan.widened({scan.ring({{-0.1, -0.08}, {0.1, -0.08}, {0.1, 0.08}, {-0.1, 0.08}}),
                    scan.ring({{-0.05, -0.04}, {0.05, -0.04}, {0.05, 0.04}, {-0.05, 0.04}}, false)});
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_NEAR(box(rings[0]).sizes().x(), 0.2 + 2 * kHalf_m, 0.01 * kHalf_m);
  EXPECT_NEAR(box(rings[0]).sizes().y(), 0.16 + 2 * kHalf_m, 0.01 * kHalf_m);
  EXPECT_NEAR(box(rings[1]).sizes().x(), 0.1 - 2 * kHalf_m, 0.01 * kHalf_m);
  EXPECT_NEAR(box(rings[1]).sizes().y(), 0.08 - 2 * kHalf_m, 0.01 * kHalf_m);
  for (const auto& ring : rings)
    for (const auto& vertex : ring.vertices) EXPECT_NEAR(scan.wall.plane.distance(vertex.point), 0, 1e-9);
}

TEST(WidenedRings, a_wall_seen_aslant_goes_farther_as_its_samples_are_farther_apart) {
  Wall scan;
  const Vec3 normal = Vec3(-0.6, 0.8, 0);  // 53 degrees off the ray along x
  scan.wall.plane = {normal, normal.x() * kWall_m};
  const stages::PlaneCoordinates coordinates(scan.wall.plane);
  const Vec3 along = Vec3(0.8, 0.6, 0), centre(kWall_m, 0, 0);
  stages::FlatRing ring;
  for (const auto& [a, z] : {std::pair{-0.01, -0.01}, {-0.01, 0.01}, {0.01, 0.01}, {0.01, -0.01}})
    ring.vertices.push_back(coordinates.vertex(centre + a * along + z * Vec3::UnitZ()));
  if (stages::signed_area2(ring) < 0) std::reverse(ring.vertices.begin(), ring.vertices.end());
  const auto wide = scan.widened({ring})[0];
  double length_m = 0, height_m = 0;
  for (const auto& a : wide.vertices)
    for (const auto& b : wide.vertices) {
      length_m = std::max(length_m, along.dot(a.point - b.point));
      height_m = std::max(height_m, a.point.z() - b.point.z());
    }
  EXPECT_NEAR(length_m, 0.02 + 2 * kHalf_m / 0.6, 0.03 * kHalf_m);
  EXPECT_NEAR(height_m, 0.02 + 2 * kHalf_m, 0.03 * kHalf_m);
}

TEST(WidenedRings, a_side_on_an_intersection_of_its_plane_stays) {
  const Wall scan;
  const auto ring = scan.ring({{-0.1, -0.08}, {0.1, -0.08}, {0.1, 0.08}, {-0.1, 0.08}});
  stages::Intersection floor{{3, 7}, {kWall_m, -1, -0.08}, {kWall_m, 1, -0.08}};
  EXPECT_NEAR(box(scan.widened({ring}, {floor})[0]).min().y(), -0.08, 1e-9);
  EXPECT_NEAR(box(scan.widened({ring}, {floor})[0]).max().y(), 0.08 + kHalf_m, 0.01 * kHalf_m);
  floor.planes[1] = 8;  // of two others
  EXPECT_NEAR(box(scan.widened({ring}, {floor})[0]).min().y(), -0.08 - kHalf_m, 0.01 * kHalf_m);
}

TEST(WidenedRings, what_would_close_or_meet_stays) {
  const Wall scan;
  const double slit = 1.5 * kHalf_m;
  const auto outer = scan.ring({{-0.1, -0.08}, {0.1, -0.08}, {0.1, 0.08}, {-0.1, 0.08}});
  const auto hole = scan.ring({{-0.05, 0}, {0.05, 0}, {0.05, slit}, {-0.05, slit}}, false);
  const auto beside = scan.ring({{0.1 + slit, -0.08}, {0.2, -0.08}, {0.2, 0.08}, {0.1 + slit, 0.08}});
  const auto rings = scan.widened({outer, hole, beside});
  ASSERT_EQ(rings.size(), 3u);
  EXPECT_EQ(box(rings[1]).sizes().y(), box(hole).sizes().y());
  EXPECT_EQ(box(rings[0]).max().x(), box(outer).max().x());
  EXPECT_EQ(box(rings[2]).min().x(), box(beside).min().x());
  EXPECT_TRUE(stages::are_simple(rings));
}

}  // namespace hybrid::testing::widened_rings_test
