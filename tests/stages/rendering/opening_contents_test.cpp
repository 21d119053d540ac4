#include "stages/rendering/opening_contents.hpp"

#include <gtest/gtest.h>

#include "stages/rendering/small_scans.hpp"

namespace hybrid::testing::opening_contents_test {
namespace {

using stages::GlazedOpening;
using Kind = stages::OpeningContent::Kind;

constexpr double kWall_m = 6, kPane_m = 0.5;

// A wall's face that looks at the scanner; its coordinates: from x = -3 and z = -1.
FaceFrame wall_frame() {
  PolygonModel model;
  model.vertices = {{-3, kWall_m, -1}, {3, kWall_m, -1}, {3, kWall_m, 2}, {-3, kWall_m, 2}};
  model.faces = {{"wall", {0, 1, 2, 3}, {}}};
  return face_frame(model, model.faces[0]);
}

// 1 m wide about x, from z = -0.5 to 0.5, its upper right corner cut off by as much.
GlazedOpening window(double x, double wider = 0, double cut = 0) {
  const double left = x + 2.5, right = x + 3.5 + wider;
  Ring2 ring = {{left, 0.5}, {right, 0.5}, {right, 1.5 - cut}, {right - cut, 1.5}, {left, 1.5}};
  if (cut == 0) ring.erase(ring.begin() + 3);
  return {wall_frame(), ring, kPane_m};
}

// The left jamb of the window about x, from the wall to the glass; it looks to the right.
PolygonModel jamb(double x) {
  PolygonModel model;
  const double at = x - 0.5, glass = kWall_m + kPane_m;
  model.vertices = {{at, kWall_m, -0.5}, {at, glass, -0.5}, {at, glass, 0.5}, {at, kWall_m, 0.5}};
  model.faces = {{"jamb", {0, 1, 2, 3}, {}}};
  return model;
}

// A bar before the glass, along the left jamb of the window about x, and its side: from the bar's front to
// `end_m` behind the wall's face.
PolygonModel barred(double x, double end_m) {
  PolygonModel model;
  const double left = x - 0.5, right = x - 0.38, front = kWall_m + 0.3, end = kWall_m + end_m;
  model.vertices = {{left, front, -0.5},  {right, front, -0.5}, {right, front, 0.5}, {left, front, 0.5},
                    {right, front, -0.5}, {right, end, -0.5},   {right, end, 0.5},   {right, front, 0.5}};
  model.faces = {{"bar", {0, 1, 2, 3}, {}}, {"side", {4, 5, 6, 7}, {}}};
  return model;
}

class OpeningContents : public ColumnBehindAWall {
 protected:
  static std::vector<PolygonModel> found(const RangeImage& image, const PolygonModel& contours,
                                         const std::vector<GlazedOpening>& openings,
                                         Kind kind = Kind::alike) {
    const std::vector<stages::SightScan> scans = {{&image, nullptr, nullptr, {}}};
    std::vector<PolygonModel> polygons;
    for (auto& content : stages::opening_contents(stages::ScanSight(scans, 0.02), contours, openings))
      if (content.kind == kind) polygons.push_back(std::move(content.polygon));
    return polygons;
  }
};

double x_of(const PolygonModel& polygon) {
  return polygon.vertices[polygon.faces[0].outer[0]].x();
}

double looks_right(const PolygonModel& polygon) {
  const auto& ring = polygon.faces[0].outer;
  const auto at = [&](std::size_t k) { return polygon.vertices[ring[k]]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).x();
}

}  // namespace

TEST_F(OpeningContents, a_jamb_stands_in_every_window_of_its_design_on_either_side) {
  const auto all = found(hiding, jamb(-1.2), {window(-1.2), window(1.2)});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_NEAR(x_of(all[0]), -0.7, 1e-9);  // the right one of the same window
  EXPECT_NEAR(x_of(all[1]), 0.7, 1e-9);
  EXPECT_NEAR(x_of(all[2]), 1.7, 1e-9);
  EXPECT_LT(looks_right(all[0]), 0);
  EXPECT_GT(looks_right(all[1]), 0);
  EXPECT_LT(looks_right(all[2]), 0);
  for (const PolygonModel& polygon : all)
    for (const Vec3& vertex : polygon.vertices) {
      EXPECT_TRUE(std::abs(vertex.y() - kWall_m) < 1e-9 || std::abs(vertex.y() - kWall_m - kPane_m) < 1e-9);
      EXPECT_NEAR(std::abs(vertex.z()), 0.5, 1e-9);
    }
}

TEST_F(OpeningContents, none_where_a_scan_shows_that_it_is_empty) {
  EXPECT_TRUE(found(through, jamb(-1.2), {window(-1.2), window(1.2)}).empty());
}

TEST_F(OpeningContents, another_design_and_one_side_of_what_is_not_symmetric_say_nothing) {
  const auto wider = found(hiding, jamb(-1.2), {window(-1.2), window(1.2, 0.1)});
  ASSERT_EQ(wider.size(), 1u);
  EXPECT_NEAR(x_of(wider[0]), -0.7, 1e-9);
  const auto askew = found(hiding, jamb(-1.2), {window(-1.2, 0, 0.3), window(1.2, 0, 0.3)});
  ASSERT_EQ(askew.size(), 1u);
  EXPECT_NEAR(x_of(askew[0]), 0.7, 1e-9);
  GlazedOpening deeper = window(1.2);
  deeper.pane_m += 0.1;
  EXPECT_EQ(found(hiding, jamb(-1.2), {window(-1.2), deeper}).size(), 1u);
}

TEST_F(OpeningContents, what_is_not_between_wall_and_glass_stands_in_no_window) {
  EXPECT_TRUE(found(hiding, jamb(0), {window(-1.2), window(1.2)}).empty());  // beside it
  PolygonModel before = jamb(-1.2), glass = jamb(-1.2);
  for (Vec3& vertex : before.vertices) vertex.y() -= 0.2;
  EXPECT_TRUE(found(hiding, before, {window(-1.2), window(1.2)}).empty());
  glass.vertices = {{-1.6, 6.5, -0.4}, {-0.8, 6.5, -0.4}, {-0.8, 6.5, 0.4}, {-1.6, 6.5, 0.4}};
  EXPECT_TRUE(found(hiding, glass, {window(-1.2), window(1.2)}).empty());
}

TEST_F(OpeningContents, a_frame_that_goes_on_behind_its_glass_has_a_back) {
  const auto backs = found(hiding, barred(-1.2, 0.62), {window(-1.2), window(1.2)}, Kind::back);
  ASSERT_EQ(backs.size(), 4u);  // of both sides of both windows, one of which shows how deep they are
  for (const PolygonModel& back : backs) {
    EXPECT_NEAR(face_area_m2(back, back.faces[0]), 0.12, 1e-9);
    EXPECT_GT(face_plane(back, back.faces[0]).normal.y(), 0.99);
    for (const Vec3& corner : back.vertices) EXPECT_NEAR(corner.y(), kWall_m + 0.62, 1e-9);
  }
  EXPECT_NEAR(backs[0].vertices[0].x(), -1.6, 0.1 + 1e-9);
}

TEST_F(OpeningContents, no_back_where_the_side_ends_at_the_glass_or_the_back_is_known_or_empty) {
  const std::vector<GlazedOpening> windows = {window(-1.2)};
  EXPECT_TRUE(found(hiding, barred(-1.2, 0.51), windows, Kind::back).empty());
  EXPECT_TRUE(found(hiding, barred(-1.2, 1.2), windows, Kind::back).empty());  // a wall's, of no frame
  EXPECT_TRUE(found(through, barred(-1.2, 0.62), windows, Kind::back).empty());
  PolygonModel known = barred(-1.2, 0.62);
  for (const double left : {-1.7, -0.82}) {
    const auto first = static_cast<std::uint32_t>(known.vertices.size());
    for (const auto& [x, z] : {std::pair{0.0, -0.5}, {0.0, 0.5}, {0.12, 0.5}, {0.12, -0.5}})
      known.vertices.emplace_back(left + x, kWall_m + 0.62, z);
    known.faces.push_back({"back", {first, first + 1, first + 2, first + 3}, {}});
  }
  EXPECT_TRUE(found(hiding, known, windows, Kind::back).empty());
}

}  // namespace hybrid::testing::opening_contents_test
