#include "stages/rendering/column_backs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "stages/rendering/column_ends.hpp"
#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::column_backs_test {
namespace {

using stages::SightScan;

std::vector<stages::ColumnBack> backs_of(const std::vector<SightScan>& scans) {
  return stages::column_backs(stages::ScanSight(scans, 0.02));
}

std::vector<stages::ColumnEnd> ends_of(const std::vector<SightScan>& scans, const PolygonModel& contours) {
  return stages::column_ends(stages::ScanSight(scans, 0.02), contours);
}

// Heights and radii, from below upwards; straight in between.
using Outline = std::vector<std::pair<double, double>>;

double radius_of(const Outline& outline, double z) {
  for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
    const auto& [low, first] = outline[k];
    const auto& [high, last] = outline[k + 1];
    if (z >= low && z <= high) return first + (last - first) * (z - low) / (high - low);
  }
  return 0;
}

// What is upright about the column's axis, seen from one side, and a wall at y = 9.
RangeImage front_of(const Cylinder& column, const Outline& outline) {
  return scan_of([&](const Vec3& ray) {
    const double wall = 9 / ray.y();
    for (double range = 5; range < 7; range += 0.001)
      if (const Vec3 at = range * ray; column.outwards(at).norm() < radius_of(outline, at.z())) return range;
    return wall;
  });
}

// A rectangle before the column's axis, its front side towards the scanner.
PolygonModel plinth(double left, double right, double before_axis) {
  PolygonModel model;
  const double y = 6 - before_axis;
  model.vertices = {{left, y, -0.9}, {right, y, -0.9}, {right, y, -0.5}, {left, y, -0.5}};
  model.faces = {{"plinth", {0, 1, 2, 3}, {}}};
  return model;
}

// With a hole.
PolygonModel panelled(double half_width, double before_axis) {
  PolygonModel model = plinth(-half_width, half_width, before_axis);
  const double y = 6 - before_axis;
  model.vertices.insert(model.vertices.end(),
                        {{-0.1, y, -0.8}, {-0.1, y, -0.6}, {0.1, y, -0.6}, {0.1, y, -0.8}});
  model.faces[0].holes = {{4, 5, 6, 7}};
  return model;
}

}  // namespace

TEST_F(ColumnBehindAWall, its_back_is_what_no_scan_knows) {
  const auto all = backs_of({{&hiding, nullptr, nullptr, {}, &columns}});
  EXPECT_EQ(all.size(), 24u);  // strips from end to end
  for (const auto& back : all) {
    EXPECT_EQ(back.scan, 0u);
    for (const Vec3& corner : back.corners) EXPECT_NEAR(column.distance(corner), 0, 1e-9);
    const auto& c = back.corners;
    EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).dot(column.outwards(c[0])), 0);  // front side outwards
  }
  EXPECT_TRUE(
      backs_of({{&hiding, nullptr, nullptr, {}, &columns}, {&through, nullptr, nullptr, {}}}).empty());
  // One that sees its front: that is known, the rest is not.
  const RangeImage front = front_of(column, {{-0.5, 0.3}, {0.5, 0.3}});
  const auto rest = backs_of({{&front, nullptr, nullptr, {}, &columns}});
  // But for strips that it meets at a grazing angle, whose samples are farther apart than the tolerance.
  EXPECT_GE(rest.size(), 12u);
  EXPECT_LE(rest.size(), 16u);
  for (const auto& back : rest) EXPECT_GT(0.5 * (back.corners[0] + back.corners[1]).y(), 6 - 0.3 / 2);
  // Where its front has a hole what is around says that it is seen.
  RangeImage holed = front;
  for (std::size_t i = 0; i < holed.count(); i += 7) holed.mask[i] = kEmpty;
  for (const auto& back : backs_of({{&holed, nullptr, nullptr, {}, &columns}}))
    EXPECT_GT(0.5 * (back.corners[0] + back.corners[1]).y(), 6 - 0.3 / 2);
  columns[0].inside = true;
  EXPECT_TRUE(backs_of({{&hiding, nullptr, nullptr, {}, &columns}}).empty());
}

TEST_F(ColumnBehindAWall, a_head_seen_from_one_side_is_as_round_on_the_other) {
  const Outline outline = {{-0.5, 0.3}, {0.5, 0.3}, {0.9, 0.5}, {0.9001, 0}};
  const RangeImage front = front_of(column, outline);
  double highest = 0;
  int above = 0;
  for (const auto& back : backs_of({{&front, nullptr, nullptr, {}, &columns}})) {
    const auto& c = back.corners;
    EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).dot(column.outwards(c[0])), 0);  // front side outwards
    for (const Vec3& corner : c) {
      if (corner.z() > 0.51) {
        EXPECT_NEAR(column.outwards(corner).norm(), radius_of(outline, corner.z()), 0.015);
      }
      highest = std::max(highest, corner.z());
      EXPECT_GE(corner.z(), -0.5 - 1e-9);
    }
    above += c[3].z() > 0.51;
  }
  EXPECT_GE(above, 12);
  EXPECT_NEAR(highest, 0.89, 0.02);
  // Square above its shaft, or with other things in it: only the shaft.
  const RangeImage square = scan_of([&](const Vec3& ray) {
    for (double range = 5; range < 7; range += 0.001) {
      const Vec3 at = range * ray;
      const double side = at.z() > 0.5 && at.z() < 0.9 ? 0.45 : 0;
      if (std::abs(at.x()) < side && std::abs(at.y() - 6) < side) return range;
    }
    return 9 / ray.y();
  });
  for (const auto& back : backs_of({{&square, nullptr, nullptr, {}, &columns}}))
    for (const Vec3& corner : back.corners) EXPECT_LE(corner.z(), 0.5 + 1e-9);
}

// What reaches no corner of a square may be a side of an octagon: only it is there again.
TEST_F(ColumnBehindAWall, a_side_of_its_base_is_there_every_quarter_of_a_turn) {
  const auto ends = ends_of({{&hiding, nullptr, nullptr, {}, &columns}}, panelled(0.3, 0.45));
  ASSERT_EQ(ends.size(), 3u);
  const double right[] = {0.45, 0, -0.45}, behind[] = {0, 0.45, 0};  // a quarter, a half, three quarters on
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(ends[k].scan, 0u);
    ASSERT_EQ(ends[k].polygon.faces.size(), 1u);
    ASSERT_EQ(ends[k].polygon.faces[0].outer, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    ASSERT_EQ(ends[k].polygon.faces[0].holes.size(), 1u);
    const auto& c = ends[k].polygon.vertices;
    ASSERT_EQ(c.size(), 8u);
    const Vec3 middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
    EXPECT_LT((middle - Vec3(right[k], 6 + behind[k], -0.7)).norm(), 1e-9) << k;
    EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).dot(column.outwards(middle)), 0) << k;
    EXPECT_NEAR((c[1] - c[0]).norm(), 0.6, 1e-9);
  }
  // The same column of another scan brings nothing new.
  EXPECT_EQ(ends_of({{&hiding, nullptr, nullptr, {}, &columns}, {&hiding, nullptr, nullptr, {}, &columns}},
                    panelled(0.3, 0.45))
                .size(),
            3u);
}

TEST_F(ColumnBehindAWall, half_a_side_of_its_plinth_says_all_four_and_the_top) {
  const std::vector<SightScan> scans = {{&hiding, nullptr, nullptr, {}, &columns}};
  for (const PolygonModel& seen : {plinth(-0.45, 0.05, 0.45), plinth(-0.05, 0.45, 0.45)}) {
    const auto ends = ends_of(scans, seen);
    ASSERT_EQ(ends.size(), 5u);
    Vec3 middles = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& c = ends[k].polygon.vertices;
      ASSERT_EQ(c.size(), 4u);
      const Vec3 middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
      middles += middle;
      EXPECT_NEAR(column.outwards(middle).norm(), 0.45, 1e-9);
      EXPECT_NEAR(middle.z(), -0.7, 1e-9);
      EXPECT_NEAR((c[1] - c[0]).norm(), 0.9, 1e-9);
      EXPECT_NEAR((c[3] - c[0]).norm(), 0.4, 1e-9);
      EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).dot(column.outwards(middle)), 0) << k;
    }
    EXPECT_LT((middles / 4 - Vec3(0, 6, -0.7)).norm(), 1e-9);
    const auto& top = ends[4].polygon;
    ASSERT_EQ(top.faces[0].outer.size(), 4u);
    ASSERT_EQ(top.faces[0].holes.size(), 1u);
    for (const Vec3& corner : top.vertices) EXPECT_NEAR(corner.z(), -0.5, 1e-9);
    const auto& c = top.vertices;
    EXPECT_GT((c[1] - c[0]).cross(c[3] - c[0]).z(), 0);
    for (const std::uint32_t vertex : top.faces[0].holes[0])
      EXPECT_NEAR(column.outwards(c[vertex]).norm(), 0.3, 1e-9);
  }
  // Both halves are of one square; whole, it is no news itself.
  PolygonModel halves = plinth(-0.45, 0.05, 0.45);
  const PolygonModel other = plinth(-0.05, 0.45, 0.45);
  halves.vertices.insert(halves.vertices.end(), other.vertices.begin(), other.vertices.end());
  halves.faces.push_back({"other half", {4, 5, 6, 7}, {}});
  EXPECT_EQ(ends_of(scans, halves).size(), 4u);
  EXPECT_EQ(ends_of(scans, panelled(0.45, 0.45)).size(), 4u);
}

// A little turned one way and the other, and farther from the axis behind it than before it.
TEST_F(ColumnBehindAWall, sides_of_a_plinth_are_where_they_were_seen) {
  const std::vector<SightScan> scans = {{&hiding, nullptr, nullptr, {}, &columns}};
  for (const double turn : {0.005, -0.005}) {
    PolygonModel two = plinth(-0.45, 0.45, 0.43);
    const PolygonModel behind = plinth(-0.45, 0.45, 0.47);
    const auto turned = [&](const Vec3& point, double rad) -> Vec3 {
      return column.foot + Eigen::AngleAxisd(rad, Vec3::UnitZ()) * Vec3(point - column.foot);
    };
    for (Vec3& point : two.vertices) point = turned(point, turn);
    for (const Vec3& point : behind.vertices) two.vertices.push_back(turned(point, std::acos(-1.0) - turn));
    two.faces.push_back({"behind", {4, 5, 6, 7}, {}});
    const auto ends = ends_of(scans, two);
    ASSERT_EQ(ends.size(), 3u);  // the two others and the top
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& c = ends[k].polygon.vertices;
      const Vec3 middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
      EXPECT_NEAR(std::abs(middle.x()), 0.45, 0.005);
      EXPECT_NEAR(middle.y(), 6.02, 0.005);
      EXPECT_NEAR((c[1] - c[0]).norm(), 0.9, 1e-9);
    }
    EXPECT_LT(ends[0].polygon.vertices[0].x() * ends[1].polygon.vertices[0].x(), 0);
  }
}

// Above the shaft the underside of what is square.
TEST_F(ColumnBehindAWall, an_abacus_has_an_underside) {
  PolygonModel abacus = plinth(-0.45, 0.45, 0.45);
  for (Vec3& vertex : abacus.vertices) vertex.z() += 1.5;
  const auto ends = ends_of({{&hiding, nullptr, nullptr, {}, &columns}}, abacus);
  ASSERT_EQ(ends.size(), 4u);
  const auto& c = ends[3].polygon.vertices;
  for (const Vec3& corner : c) EXPECT_NEAR(corner.z(), 0.6, 1e-9);
  EXPECT_LT((c[1] - c[0]).cross(c[3] - c[0]).z(), 0);
}

// A level seen there says more exactly where its sides end than their own samples do, if it is near.
TEST_F(ColumnBehindAWall, an_abacus_ends_at_the_level_that_was_seen) {
  for (const double level_m : {0.58, 0.62, 0.54}) {
    PolygonModel abacus = plinth(-0.45, 0.45, 0.45);
    for (Vec3& vertex : abacus.vertices) vertex.z() += 1.5;
    for (const auto& [x, y] : {std::pair{-0.4, 5.6}, {-0.4, 6.4}, {-0.3, 6.4}, {-0.3, 5.6}})
      abacus.vertices.emplace_back(x, y, level_m);
    abacus.faces.push_back({"underside", {4, 5, 6, 7}, {}});
    const auto ends = ends_of({{&hiding, nullptr, nullptr, {}, &columns}}, abacus);
    ASSERT_GE(ends.size(), 4u);
    for (const Vec3& corner : ends[3].polygon.vertices)
      EXPECT_NEAR(corner.z(), std::abs(level_m - 0.6) < 0.04 ? level_m : 0.6, 1e-9);
  }
}

TEST_F(ColumnBehindAWall, a_spur_of_its_contour_makes_no_plinth_higher) {
  PolygonModel spurred = plinth(-0.45, 0.45, 0.45);
  double top_m = -1;
  for (const Vec3& vertex : spurred.vertices) top_m = std::max(top_m, vertex.z());
  // A tooth of 5 cm on the upper border, a tenth as wide as that.
  auto& ring = spurred.faces[0].outer;
  std::vector<std::uint32_t> toothed;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec3 a = spurred.vertices[ring[k]], b = spurred.vertices[ring[(k + 1) % ring.size()]];
    toothed.push_back(ring[k]);
    if (std::min(a.z(), b.z()) < top_m) continue;
    for (const auto& [share, up_m] : {std::pair{0.4, 0.0}, {0.4, 0.05}, {0.5, 0.05}, {0.5, 0.0}}) {
      toothed.push_back(static_cast<std::uint32_t>(spurred.vertices.size()));
      spurred.vertices.push_back(a + share * (b - a) + up_m * Vec3::UnitZ());
    }
  }
  ring = toothed;
  const auto ends = ends_of({{&hiding, nullptr, nullptr, {}, &columns}}, spurred);
  ASSERT_FALSE(ends.empty());
  double highest_m = -1;
  for (const stages::ColumnEnd& end : ends)
    for (const Vec3& corner : end.polygon.vertices) highest_m = std::max(highest_m, corner.z());
  EXPECT_NEAR(highest_m, top_m, 0.003);
}

// Two columns on round bases; of the right one a low wall hides the base and the foot of the shaft.
class ColumnsOfOneDesign : public ::testing::Test {
 protected:
  static constexpr double kHidden_m = -0.2;
  const Outline outline = {{-0.8, 0.4}, {-0.5, 0.4}, {-0.4999, 0.3}, {0.5, 0.3}};

  ColumnsOfOneDesign() {
    for (const double x : {-1.2, 1.2}) {
      Cylinder column;
      column.id = static_cast<std::uint32_t>(columns.size() + 1);
      column.foot = {x, 6, x < 0 ? -0.5 : kHidden_m};
      column.length_m = 0.5 - column.foot.z();
      column.radius_m = 0.3;
      columns.push_back(column);
    }
  }

  double range(const Vec3& ray) const {
    const Vec3 low = 4 / ray.y() * ray;
    if (low.x() > 0.2 && low.z() < kHidden_m * 4 / 6) return 4 / ray.y();
    for (double range = 5; range < 7; range += 0.001)
      for (const Cylinder& column : columns)
        if (const Vec3 at = range * ray; column.outwards(at).norm() < radius_of(outline, at.z()))
          return range;
    return 9 / ray.y();
  }

  // Of the right one, below its foot.
  std::vector<stages::ColumnBack> hidden_part() const {
    const RangeImage image = scan_of([&](const Vec3& ray) { return range(ray); });
    std::vector<stages::ColumnBack> found;
    for (const auto& back : backs_of({{&image, nullptr, nullptr, {}, &columns}}))
      if (back.cylinder == 2 && back.corners[0].z() < kHidden_m - 0.01) found.push_back(back);
    return found;
  }

  std::vector<Cylinder> columns;
};

TEST_F(ColumnsOfOneDesign, what_is_hidden_of_one_is_as_another_shows_it) {
  const auto hidden = hidden_part();
  ASSERT_GE(hidden.size(), 24u);  // shaft and base, all around
  double lowest = 0;
  for (const auto& back : hidden)
    for (const Vec3& corner : back.corners) {
      lowest = std::min(lowest, corner.z());
      if (std::abs(corner.z() + 0.5) < 0.03) continue;  // where the base begins
      EXPECT_NEAR(columns[1].outwards(corner).norm(), radius_of(outline, corner.z()), 0.015);
      EXPECT_NEAR(corner.x(), 1.2, 0.42);
    }
  EXPECT_LT(lowest, -0.8 + 0.01 * 6 + 0.02);  // as far as rows of samples, then slices, reach down to -0.8
  EXPECT_GE(lowest, -0.8);
}

TEST_F(ColumnsOfOneDesign, another_design_says_nothing) {
  const auto only_known_below = [&](const char* what) { EXPECT_TRUE(hidden_part().empty()) << what; };
  columns[0].radius_m = 0.35;
  only_known_below("thicker");
  columns[0].radius_m = 0.3;
  columns[0].axis = Vec3(0, 0.1, 1).normalized();
  only_known_below("it leans");
  columns.erase(columns.begin());
  only_known_below("alone");
}

TEST_F(ColumnBehindAWall, its_plinth_may_be_that_of_a_column_like_it) {
  Cylinder other = column;
  other.id = 2;
  other.foot += Vec3(2, 0.5, 0.3);  // of its shaft less was seen
  other.length_m -= 0.3;
  const auto ends = [&](const Cylinder& second, const RangeImage& image) {
    columns = {column, second};
    return ends_of({{&image, nullptr, nullptr, {}, &columns}}, plinth(-0.45, 0.45, 0.45));
  };
  const auto both = ends(other, hiding);
  ASSERT_EQ(both.size(), 4u + 5u);
  for (std::size_t k = 4; k < 8; ++k) {
    EXPECT_EQ(both[k].cylinder, 2u);
    const auto& c = both[k].polygon.vertices;
    const Vec3 middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
    EXPECT_NEAR(other.outwards(middle).norm(), 0.45, 1e-9);
    EXPECT_NEAR(middle.z(), -0.7, 1e-9);  // at the same height
  }
  EXPECT_TRUE(ends(other, through).empty());
  Cylinder thicker = other;
  thicker.radius_m = 0.35;
  EXPECT_EQ(ends(thicker, hiding).size(), 4u);
  Cylinder high = other;
  high.foot.z() = 1;
  EXPECT_EQ(ends(high, hiding).size(), 4u);
}

TEST_F(ColumnBehindAWall, no_plinth_where_it_is_empty_too_wide_or_far_or_no_column) {
  const auto sides = [&](const RangeImage& image, const PolygonModel& model) {
    return ends_of({{&image, nullptr, nullptr, {}, &columns}}, model).size();
  };
  EXPECT_EQ(sides(hiding, plinth(-0.45, 0.45, 0.45)), 4u);
  EXPECT_EQ(sides(through, plinth(-0.45, 0.45, 0.45)), 0u);
  EXPECT_EQ(sides(hiding, plinth(-0.8, 0.8, 0.45)), 0u);
  EXPECT_EQ(sides(hiding, plinth(-0.3, 0.3, 0.6)), 0u);
  EXPECT_EQ(sides(hiding, {}), 0u);
  // Wider than it is far from the axis, on one side: no square.
  EXPECT_EQ(sides(hiding, plinth(-0.45, 0.55, 0.45)), 3u);
  columns[0].inside = true;
  EXPECT_EQ(sides(hiding, plinth(-0.45, 0.45, 0.45)), 0u);
}

}  // namespace hybrid::testing::column_backs_test
