#include "stages/rendering/coverage.hpp"

#include <gtest/gtest.h>

#include "cases/room_scene.hpp"
#include "device.hpp"

namespace hybrid::testing {
namespace {

// A closed house of 6 x 5 x 3 m, its walls 30 cm thick, on ground of 60 x 60 m; a photograph inside that
// looks at a wall, one outside that looks at the sky, and scanners that have been everywhere.
stages::RenderScene house() {
  RoomScene room;
  room.add_box({0, 0, 0}, {6, 5, 3}, true);
  room.add_box({-0.3, -0.3, -0.2}, {6.3, 5.3, 3.3}, false);
  auto& scene = room.scene;
  const auto base = static_cast<std::uint32_t>(scene.proxy.vertices.size());
  for (const auto& [x, y] : {std::pair{-27, -27}, {33, -27}, {33, 33}, {-27, 33}})
    scene.proxy.vertices.emplace_back(x, y, -0.1);
  scene.proxy.faces.push_back({"ground", {base, base + 1, base + 2, base + 3}, {}});
  for (const auto& [eye, target] :
       {std::pair{Vec3(3, 2, 1.5), Vec3(6, 2, 1.5)}, {Vec3(3, -10, 1.5), Vec3(3, -20, 20)}}) {
    scene.photographs.push_back(look_at(eye, target, Vec3::UnitZ(), 60, 64, 48));
    scene.photographs.back().name = std::to_string(scene.photographs.size());
    scene.photograph_pixels.emplace_back(64, 48, 3, std::uint8_t{128});
  }
  scene.scanners = {{3, 2.5, 1.5}, {3, -8, 12}, {3, 14, 12}, {-10, 2, 12}, {16, 2, 12}};
  return scene;
}

stages::Coverage covered(const stages::RenderScene& scene, const stages::CoverageOptions& options) {
  stages::RenderOptions render;
  render.equalise = false;
  stages::Renderer renderer(queue(), scene, render);
  return stages::measure_coverage(renderer, scene, options);
}

bool is_inside(const Vec3& point) {
  return point.x() > 0 && point.x() < 6 && point.y() > 0 && point.y() < 5 && point.z() > 0 && point.z() < 3;
}

}  // namespace

TEST(Coverage, next_cameras_stand_where_a_person_reaches_and_spread_over_what_is_red) {
  const auto scene = house();
  stages::CoverageOptions options;
  options.coverage_texel_m = 0.25;
  const auto coverage = covered(scene, options);
  ASSERT_EQ(coverage.next.size(), 6u);
  int inside = 0;
  double before = 1e9;
  for (const auto& camera : coverage.next) {
    EXPECT_LE(camera.position.z(), 3.0 + 1e-6) << camera.position.transpose();
    EXPECT_GE(camera.position.z(), 0.8) << camera.position.transpose();
    inside += is_inside(camera.position);
    EXPECT_LE(camera.gained_m2, before + 1e-9);
    before = camera.gained_m2;
  }
  EXPECT_GE(inside, 1);
  EXPECT_LE(inside, 5);
  options.next_camera_height_m = 1.5;
  for (const auto& camera : covered(scene, options).next) EXPECT_LE(camera.position.z(), 1.5 + 1e-6);
}

// Of a fine grid, of which not all is asked at once, as of a coarse one.
TEST(Coverage, areas_are_the_same_for_any_texel) {
  const auto scene = house();
  stages::CoverageOptions options;
  options.next_cameras = 0;
  options.coverage_texel_m = 0.1;
  const auto fine = covered(scene, options);
  options.coverage_texel_m = 0.25;
  const auto coarse = covered(scene, options);
  EXPECT_GT(fine.area_m2, (1 << 18) * 0.1 * 0.1);  // more texels than are asked at a time
  ASSERT_EQ(fine.faces.size(), scene.proxy.faces.size());
  double area_m2 = 0, unseen_m2 = 0;
  for (std::size_t f = 0; f < fine.faces.size(); ++f) {
    EXPECT_EQ(fine.faces[f].area_m2, face_area_m2(scene.proxy, scene.proxy.faces[f]));
    EXPECT_NEAR(fine.faces[f].unseen_m2, coarse.faces[f].unseen_m2, 0.02 * fine.faces[f].area_m2 + 0.3) << f;
    area_m2 += fine.faces[f].area_m2, unseen_m2 += fine.faces[f].unseen_m2;
  }
  EXPECT_DOUBLE_EQ(fine.area_m2, area_m2);
  EXPECT_DOUBLE_EQ(fine.unseen_m2, unseen_m2);
  EXPECT_LT(fine.unseen_m2, fine.area_m2 - 5);  // the wall before the photograph
}

}  // namespace hybrid::testing
