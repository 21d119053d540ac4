#include "stages/editing/panes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stages/scan/stray_samples.hpp"

namespace hybrid::testing::panes_test {
namespace {

using stages::Opening;
using stages::Openings;
using stages::PassedRay;

// A window of 1 x 2 m: every `of`-th beam returns from its glass, the others from the room behind it.
std::vector<PassedRay> window(int of) {
  std::vector<PassedRay> rays;
  for (int row = 0; row < 40; ++row)
    for (int col = 0; col < 20; ++col)
      rays.push_back({{0.05 * col, 0.05 * row}, (row * 20 + col) % of == 0 ? 0.15 + 0.001 * (col % 5) : 4.0});
  return rays;
}

// A wall at y = 0 with its front towards -y, and another, 40 cm behind it, with its front towards +y.
PolygonModel two_sided_wall() {
  PolygonModel model;
  model.vertices = {{0, 0, 0},   {4, 0, 0},   {4, 0, 3},   {0, 0, 3},
                    {0, 0.4, 0}, {4, 0.4, 0}, {4, 0.4, 3}, {0, 0.4, 3}};
  model.faces = {{"outside", {0, 1, 2, 3}, {}}, {"inside", {5, 4, 7, 6}, {}}};
  return model;
}

Opening glazed(std::size_t face, std::int64_t rays, double pane_m) {
  Opening opening;
  opening.face = face;
  opening.ring = {{1, 1}, {3, 1}, {3, 2}, {1, 2}};
  opening.rays = rays;
  opening.pane_m = pane_m;
  opening.cut = true;
  return opening;
}

}  // namespace

TEST(Panes, glass_returns_some_beams_from_one_plane_and_lets_those_beside_them_through) {
  const auto pane = stages::pane_depths(window(3), 2).sure;
  ASSERT_TRUE(pane.has_value());
  EXPECT_NEAR(*pane, 0.152, 0.003);
}

TEST(Panes, mullions_and_reveals_before_the_glass_do_not_move_it) {
  std::vector<PassedRay> rays = window(3);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 20 % 3 == 0) rays[i].depth_m = 0.10 + 0.001 * static_cast<double>(i % 4);
    if (i % 20 == 1) rays[i].depth_m = 0.002 * static_cast<double>(i / 20 % 70);  // a reveal, aslant
  }
  const auto pane = stages::pane_depths(rays, 2).sure;
  ASSERT_TRUE(pane.has_value());
  EXPECT_NEAR(*pane, 0.152, 0.003);
}

TEST(Panes, tracery_before_the_glass_is_no_pane) {
  // Every second four columns are a bar, at 12 cm; of the beams between them half return from 27 cm.
  std::vector<PassedRay> rays;
  for (int row = 0; row < 56; ++row)
    for (int col = 0; col < 56; ++col) {
      const double glass_m = (row + col) % 2 == 0 ? 0.27 : 4.0;
      rays.push_back({{0.0125 + 0.025 * col, 0.0125 + 0.025 * row}, (col + 2) % 8 < 4 ? 0.12 : glass_m});
    }
  const auto pane = stages::pane_depths(rays, 1.96).sure;
  ASSERT_TRUE(pane.has_value());
  EXPECT_EQ(*pane, 0.27);
}

TEST(Panes, a_door_ajar_and_an_open_window_have_none) {
  std::vector<PassedRay> ajar = window(3);
  for (PassedRay& ray : ajar)
    ray.depth_m = ray.at.x() < 0.45 ? 0.15 : 4.0;  // the leaf, and beside it the room
  EXPECT_FALSE(stages::pane_depths(ajar, 2).sure.has_value());
  std::vector<PassedRay> open = window(3);
  for (PassedRay& ray : open) ray.depth_m = 4 + 0.1 * ray.at.y();
  EXPECT_FALSE(stages::pane_depths(open, 2).likely.has_value());
  EXPECT_FALSE(stages::pane_depths({}, 2).likely.has_value());
}

// A porch of 2 x 2 m: 58 cm behind the wall's face another wall with a doorway in its middle, and a room
// behind that. Two scanners 3 m before it see it from both sides, so that rays which pass the face at one
// place come out of the doorway and of the wall beside it.
TEST(Panes, rays_of_two_stations_that_cross_on_their_way_to_a_doorway_are_no_glass) {
  constexpr double kBack_m = 0.58;
  std::vector<PassedRay> rays;
  for (const double station : {-3.0, 3.0})
    for (int row = 0; row < 100; ++row)
      for (int col = 0; col < 100; ++col) {
        const Vec2 at(0.01 + 0.02 * col, 0.01 + 0.02 * row);
        const Vec2 slope((at.x() - 1 - station) / 3, (at.y() - 1) / 3);
        const Vec2 there = at + kBack_m * slope;
        rays.push_back({at, there.x() > 0.6 && there.x() < 1.4 ? 5.0 : kBack_m, slope});
      }
  EXPECT_FALSE(stages::pane_depths(rays, 4).sure.has_value());
  for (PassedRay& ray : rays) ray.slope.setZero();  // as if they all met the face squarely
  EXPECT_TRUE(stages::pane_depths(rays, 4).sure.has_value());
}

TEST(Panes, glass_behind_a_deep_reveal_is_likely) {
  // On twelve of 28 columns some beams return from the reveal's edge, the others farther in; on eight some
  // from the glass, the others from the room behind it, as all do on the last eight.
  std::vector<PassedRay> rays;
  for (int row = 0; row < 40; ++row)
    for (int col = 0; col < 28; ++col) {
      const bool returns = (row + col) % 2 == 0;
      const double depth_m = col < 12 ? (returns ? 0.14 : 0.30) : returns && col < 20 ? 0.45 : 4.0;
      rays.push_back({{0.025 + 0.05 * col, 0.025 + 0.05 * row}, depth_m});
    }
  const stages::PaneDepths pane = stages::pane_depths(rays, 2.8);
  EXPECT_FALSE(pane.sure.has_value());
  ASSERT_TRUE(pane.likely.has_value());
  EXPECT_EQ(*pane.likely, 0.45);
}

TEST(Panes, a_likely_pane_stands_where_the_other_side_of_the_wall_is_sure_of_one) {
  const PolygonModel model = two_sided_wall();
  Openings openings;
  openings.openings = {glazed(0, 100, 0.15), glazed(1, 900, 0.22)};
  Opening& inside = openings.openings[1];
  inside.likely_pane_m = inside.pane_m;
  inside.pane_m.reset();
  stages::confirm_panes(model, openings);
  ASSERT_TRUE(inside.pane_m.has_value());
  EXPECT_EQ(*inside.pane_m, 0.22);
  inside.pane_m.reset();
  inside.likely_pane_m = 0.05;  // too far from the other side's
  stages::confirm_panes(model, openings);
  EXPECT_FALSE(inside.pane_m.has_value());
  inside.likely_pane_m = 0.22;
  openings.openings[0].pane_m.reset();  // which is sure of none
  stages::confirm_panes(model, openings);
  EXPECT_FALSE(inside.pane_m.has_value());
}

// Two windows beside each other; both sides of the first one's glass were seen, of the other's the outer one.
Openings two_windows() {
  Openings openings;
  openings.openings = {glazed(0, 100, 0.15), glazed(1, 900, 0.22), glazed(0, 100, 0.14), glazed(1, 90, 0)};
  openings.openings[2].ring = {{3.2, 1}, {3.8, 1}, {3.8, 2}, {3.2, 2}};
  openings.openings[3].ring = {{0.2, 1}, {0.8, 1}, {0.8, 2}, {0.2, 2}};  // as the inner face counts
  openings.openings[3].pane_m.reset();
  return openings;
}

TEST(Panes, glass_seen_from_one_side_is_as_thick_as_in_another_window_of_the_wall) {
  PolygonModel model = two_sided_wall();
  Openings openings = two_windows();
  Opening& inside = openings.openings[3];
  inside.carried_from = 0;
  inside.pane_m = 0.1;  // of a few rays that passed an outline which this side has not seen
  stages::complete_panes(model, openings);
  ASSERT_TRUE(inside.pane_m.has_value());
  EXPECT_NEAR(*inside.pane_m, 0.4 - 0.14 - 0.03, 1e-9);
  EXPECT_EQ(inside.pane_from, 0u);
  EXPECT_EQ(*openings.openings[1].pane_m, 0.22);  // what was seen stays
  EXPECT_FALSE(openings.openings[1].pane_from.has_value());
  const auto added = stages::add_panes(openings, model);
  ASSERT_EQ(added.size(), 4u);
  EXPECT_EQ(model.faces[added[3]].name, "inside-pane-2");
  EXPECT_NEAR(model.vertices[model.faces[added[3]].outer[0]].y(), 0.17, 1e-9);
}

TEST(Panes, glass_of_unknown_thickness_has_one_side) {
  const PolygonModel model = two_sided_wall();
  Openings none_known = two_windows();
  none_known.openings[1].pane_m.reset();
  stages::complete_panes(model, none_known);
  EXPECT_FALSE(none_known.openings[3].pane_m.has_value());
  EXPECT_FALSE(none_known.openings[1].pane_m.has_value());
  Openings elsewhere = two_windows();  // nor is there glass where the other side shows none
  elsewhere.openings[2].ring = {{2, 1}, {2.6, 1}, {2.6, 2}, {2, 2}};
  stages::complete_panes(model, elsewhere);
  EXPECT_FALSE(elsewhere.openings[3].pane_m.has_value());
  Openings uncut = two_windows();
  uncut.openings[3].cut = false;
  stages::complete_panes(model, uncut);
  EXPECT_FALSE(uncut.openings[3].pane_m.has_value());
}

TEST(Panes, glass_that_is_thicker_than_a_centimetre_has_a_face_on_either_side) {
  PolygonModel model = two_sided_wall();
  Openings openings;
  openings.openings = {glazed(0, 100, 0.15), glazed(1, 900, 0.22)};
  const auto added = stages::add_panes(openings, model);
  ASSERT_EQ(added.size(), 2u);
  EXPECT_EQ(model.faces[added[0]].name, "inside-pane-1");
  EXPECT_EQ(model.faces[added[1]].name, "outside-pane-1");
  EXPECT_NEAR(model.vertices[model.faces[added[0]].outer[0]].y(), 0.18, 1e-9);  // each before the other
  EXPECT_NEAR(model.vertices[model.faces[added[1]].outer[0]].y(), 0.15, 1e-9);
  openings.openings[0].pane_m = 0.175;
  model = two_sided_wall();
  EXPECT_EQ(stages::add_panes(openings, model).size(), 1u);
}

TEST(Panes, a_pane_seen_through_both_sides_of_its_wall_is_one_face_where_more_beams_say_it_is) {
  PolygonModel model = two_sided_wall();
  Openings openings;
  openings.openings = {glazed(0, 100, 0.17), glazed(1, 900, 0.25)};
  const auto added = stages::add_panes(openings, model);
  ASSERT_EQ(added.size(), 1u);
  EXPECT_EQ(model.faces[added[0]].name, "inside-pane-1");
  ASSERT_EQ(model.faces[added[0]].outer.size(), 4u);
  for (const std::uint32_t v : model.faces[added[0]].outer) EXPECT_NEAR(model.vertices[v].y(), 0.15, 1e-9);
  openings.openings[0].pane_m = 0.02;  // another one
  model = two_sided_wall();
  EXPECT_EQ(stages::add_panes(openings, model).size(), 2u);
  openings.openings[0].cut = openings.openings[1].cut = false;
  EXPECT_TRUE(stages::add_panes(openings, model).empty());
}

TEST(Panes, samples_behind_a_pane_on_their_ray_are_strays) {
  PolygonModel model = two_sided_wall();
  Openings openings;
  openings.openings = {glazed(0, 100, 0.15)};
  const auto panes = stages::add_panes(openings, model);
  // From (2, -3, 1.5): through the pane, on it, before it, and through the wall beside it.
  RangeImage image = make_range_image(1, 4);
  const Vec3 points[4] = {{2.2, 2, 1.5}, {2.2, 0.151, 1.5}, {2.2, -1, 1.5}, {3.8, 2, 1.5}};
  const Pose world_from_scan{1, Eigen::Quaterniond::Identity(), {2, -3, 1.5}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 point = points[i] - world_from_scan.translation;
    image.x[i] = static_cast<float>(point.x());
    image.y[i] = static_cast<float>(point.y());
    image.z[i] = static_cast<float>(point.z());
    image.mask[i] = kMeasured;
  }
  std::vector<std::uint8_t> stray(4, stages::kNotStray);
  stages::mark_through_glass(image, world_from_scan, model, panes, stray);
  EXPECT_EQ(stray[0], stages::kThroughGlass);
  for (const std::size_t i : {1u, 2u}) EXPECT_EQ(stray[i], stages::kNotStray) << i;
  EXPECT_EQ(stray[3], stages::kNotStray);
}

}  // namespace hybrid::testing::panes_test
