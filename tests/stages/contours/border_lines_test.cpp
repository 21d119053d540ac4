#include "stages/contours/border_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "stages/contours/contour_polygons.hpp"
#include "stages/contours/widened_rings.hpp"

namespace hybrid::testing::border_lines_test {
namespace {

constexpr double kStep_rad = 0.01, kWall_m = 2, kStep_m = kStep_rad * kWall_m;
constexpr int kHalfSide = 20;  // of the grid

// A scanner at the origin that looks along x at a wall, 2 m away, of which it shows what lies between two
// borders: heights over y.
struct Strip {
  RangeImage image = make_range_image(2 * kHalfSide + 1, 2 * kHalfSide + 1);
  Supercluster wall;

  Strip(const std::function<double(double)>& low, const std::function<double(double)>& high) {
    for (int k = 0; k <= 2 * kHalfSide; ++k) {
      image.elevation_rad[static_cast<std::size_t>(k)] = (kHalfSide - k) * kStep_rad;
      image.azimuth_rad[static_cast<std::size_t>(k)] = (k - kHalfSide) * kStep_rad;
    }
    wall.id = 7;
    wall.plane = {{-1, 0, 0}, -kWall_m};
    std::vector<Vec3> below, above;  // the outermost samples of every column
    for (int k = -kHalfSide; k <= kHalfSide; ++k) {
      const double y = k * kStep_m;
      below.emplace_back(kWall_m, y, kStep_m * std::ceil(low(y) / kStep_m));
      above.emplace_back(kWall_m, y, kStep_m * std::floor(high(y) / kStep_m));
    }
    std::reverse(above.begin(), above.end());
    std::vector<Vec3> ring = below;
    const auto up = [&](const Vec3& from, const Vec3& to) {
      const double way = to.z() > from.z() ? kStep_m : -kStep_m;
      for (double z = from.z() + way; std::abs(z - to.z()) > kStep_m / 2; z += way)
        ring.emplace_back(kWall_m, from.y(), z);
    };
    up(below.back(), above.front());
    ring.insert(ring.end(), above.begin(), above.end());
    up(above.back(), below.front());
    // The scanner sees it from the front, where y goes to the left.
    std::reverse(ring.begin(), ring.end());
    wall.contours = {{ring, true}};
  }

  std::vector<stages::FlatRing> rings() const { return stages::flat_rings(image, wall, 0.75); }
  std::vector<stages::FlatRing> lined() const {
    return stages::with_border_lines(image, wall, rings(), 0.36, 1);
  }
  std::vector<stages::FlatRing> widened(const std::vector<stages::FlatRing>& rings) const {
    return stages::widened_rings(image, wall, {}, 0.5, rings);
  }
};

// Of the vertices above the middle of the strip, from its upper border; in steps.
double farthest_off(const stages::FlatRing& ring, const std::function<double(double)>& middle,
                    const std::function<double(double)>& high) {
  double most_m = 0;
  for (const auto& vertex : ring.vertices)
    if (vertex.point.z() > middle(vertex.point.y()))
      most_m = std::max(most_m, std::abs(vertex.point.z() - high(vertex.point.y())));
  return most_m / kStep_m;
}

double slanted(double y) {
  return 0.27 * y + 0.103;
}
double slanted_below(double y) {
  return 0.27 * y - 0.098;
}

}  // namespace

TEST(BorderLines, a_slanted_border_is_one_line_where_the_plane_ends) {
  const Strip strip(slanted_below, slanted);
  const auto middle = [](double y) { return 0.27 * y; };
  const auto raw = strip.rings(), lined = strip.lined();
  ASSERT_EQ(raw.size(), 1u);
  ASSERT_EQ(lined.size(), 1u);
  EXPECT_GT(raw[0].vertices.size(), 4u);
  EXPECT_EQ(lined[0].vertices.size(), 4u);
  EXPECT_GT(farthest_off(strip.widened(raw)[0], middle, slanted), 0.3);
  EXPECT_LT(farthest_off(strip.widened(lined)[0], middle, slanted), 0.1);
  for (const auto& vertex : lined[0].vertices) EXPECT_NEAR(strip.wall.plane.distance(vertex.point), 0, 1e-9);
  EXPECT_EQ(stages::signed_area2(lined[0]) > 0, stages::signed_area2(raw[0]) > 0);
}

TEST(BorderLines, a_step_of_the_border_stays) {
  const auto low = [](double) { return -0.1; };
  const auto high = [](double y) { return y < 0.003 ? 0.101 : 0.101 + 2 * kStep_m; };
  const Strip strip(low, high);
  const auto lined = strip.lined();
  ASSERT_EQ(lined.size(), 1u);
  double most_m = 0, least_m = 1;
  for (const auto& vertex : lined[0].vertices)
    if (vertex.point.z() > 0) {
      most_m = std::max(most_m, vertex.point.z());
      least_m = std::min(least_m, vertex.point.z());
    }
  EXPECT_NEAR(least_m, 0.1, 1e-6);
  EXPECT_NEAR(most_m, 0.1 + 2 * kStep_m, 1e-6);
}

// Straightened contours have two points on the line in which two planes meet.
TEST(BorderLines, a_side_on_an_intersection_stays_and_its_corners_lie_on_it) {
  Strip strip(slanted_below, slanted);
  std::vector<Vec3> points;
  const double end_m = kHalfSide * kStep_m;
  const auto below = [](double y) { return 0.1 * y - 0.2; };
  for (const Vec3& point : strip.wall.contours[0].points)
    if (point.z() > slanted(point.y()) - kStep_m) points.push_back(point);
  // From the right end of what is above, seen from the front, to its left end.
  std::rotate(points.begin(),
              std::min_element(points.begin(), points.end(),
                               [](const Vec3& a, const Vec3& b) {
                                 return a.y() != b.y() ? a.y() < b.y() : a.z() < b.z();
                               }),
              points.end());
  const bool ends_right = points.back().y() > 0;
  points.emplace_back(kWall_m, ends_right ? end_m : -end_m, below(ends_right ? end_m : -end_m));
  points.emplace_back(kWall_m, ends_right ? -end_m : end_m, below(ends_right ? -end_m : end_m));
  strip.wall.contours[0].points = points;
  const auto lined = strip.lined();
  ASSERT_EQ(lined.size(), 1u);
  EXPECT_EQ(lined[0].vertices.size(), 4u);
  int on_line = 0;
  for (const auto& vertex : lined[0].vertices)
    on_line += std::abs(vertex.point.z() - below(vertex.point.y())) < 1e-9;
  EXPECT_EQ(on_line, 2);
}

TEST(BorderLines, no_sample_lies_farther_from_a_curved_border_than_before) {
  const auto arch = [](double y) { return std::sqrt(std::max(0.45 * 0.45 - y * y, 0.0)) - 0.15; };
  const Strip strip([](double) { return -0.1; }, arch);
  const auto lined = strip.lined();
  ASSERT_EQ(lined.size(), 1u);
  EXPECT_GT(lined[0].vertices.size(), 6u);
  for (const Vec3& point : strip.wall.contours[0].points) {
    double nearest_m = 1;
    const auto& v = lined[0].vertices;
    for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
      const Vec3 along = v[i].point - v[j].point;
      const double share = std::clamp(along.dot(point - v[j].point) / along.squaredNorm(), 0.0, 1.0);
      nearest_m = std::min(nearest_m, (v[j].point + share * along - point).norm());
    }
    EXPECT_LT(nearest_m, 1.1 * kStep_m);
  }
}

TEST(BorderLines, rings_that_would_meet_stay_as_they_are) {
  Strip strip(slanted_below, slanted);
  const auto same = [](const stages::FlatRing& a, const stages::FlatRing& b) {
    return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                      [](const auto& p, const auto& q) { return p.point == q.point; });
  };
  EXPECT_FALSE(same(strip.lined()[0], strip.rings()[0]));
  // A hole up to 1 mm below the ring's outermost vertex, which the line leaves outside.
  const auto ring = strip.rings()[0];
  const auto off = [](const stages::RingVertex& vertex) {
    return std::abs(vertex.point.y()) < 0.3 ? vertex.point.z() - slanted(vertex.point.y()) : -1;
  };
  const Vec3 top =
      std::max_element(ring.vertices.begin(), ring.vertices.end(), [&](const auto& a, const auto& b) {
        return off(a) < off(b);
      })->point;
  strip.wall.contours.push_back(
      {{top - Vec3(0, 0, 0.001), top - Vec3(0, 0.002, 0.02), top - Vec3(0, -0.002, 0.02)}, false});
  const auto raw = strip.rings(), lined = strip.lined();
  ASSERT_EQ(raw.size(), 2u);
  ASSERT_EQ(lined.size(), 2u);
  for (std::size_t r = 0; r < 2; ++r) EXPECT_TRUE(same(lined[r], raw[r])) << r;
}

}  // namespace hybrid::testing::border_lines_test
