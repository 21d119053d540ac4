#include "stages/rendering/bake_atlas.hpp"

#include <gtest/gtest.h>

#include "cases/holed_room.hpp"
#include "device.hpp"

namespace hybrid::testing::bake_atlas_test {
namespace {

using stages::Atlas;
using stages::AtlasOptions;
using stages::AtlasPage;

const RoomScene& room() {
  static const RoomScene instance = holed_room(8, 240, 180);
  return instance;
}

AtlasOptions small_texels() {
  AtlasOptions options;
  options.texel_m = 0.04;
  options.page = 256;
  options.pages = 16;
  options.padding = 3;
  return options;
}

std::vector<AtlasPage> bake(const stages::RenderScene& scene, const AtlasOptions& options, Atlas& atlas,
                            int tile = 1024) {
  stages::RenderOptions render;
  render.tile = tile;
  stages::Renderer renderer(queue(), scene, render);
  atlas = stages::plan_atlas(renderer, scene, options);
  std::vector<AtlasPage> pages;
  for (std::size_t page = 0; page < atlas.layout.pages.size(); ++page)
    pages.push_back(stages::bake_page(renderer, scene, atlas, static_cast<int>(page)));
  return pages;
}

}  // namespace

TEST(BakeAtlas, seen_texels_have_the_paint_of_their_place_and_unseen_ones_are_red) {
  Atlas atlas;
  const auto pages = bake(room().scene, small_texels(), atlas);
  ASSERT_GT(pages.size(), 1u);
  std::size_t seen = 0, off = 0, red = 0, wrongly_seen = 0;
  for (const auto& chart : atlas.charts) {
    EXPECT_FALSE(chart.back) << chart.face;  // the room's faces are closed: nothing sees their backs
    const auto mask = stages::chart_mask(chart, room().scene.proxy);
    const AtlasPage& page = pages[static_cast<std::size_t>(chart.page)];
    for (int row = 0; row < chart.rows; ++row)
      for (int col = 0; col < chart.cols; ++col) {
        if (!mask[static_cast<std::size_t>(row * chart.cols + col)]) continue;
        const std::uint8_t* coverage = page.coverage.at(chart.x + col, chart.y + row);
        const std::uint8_t* colour = page.colour.at(chart.x + col, chart.y + row);
        const Vec3 point = chart.point(col + 0.5, row + 0.5);
        if (coverage[1] == 0) {
          EXPECT_EQ(colour[0], 255);
          EXPECT_EQ(colour[1], 0);
          ++red;
          continue;
        }
        ++seen;
        bool visible = false;  // to anything that no sample hides
        for (const Photograph& photograph : room().scene.photographs) {
          const auto at = photograph.camera.project(photograph.cam_from_world * point);
          const Vec3 ray = (point - photograph.centre()).normalized();
          visible |=
              at && room().hit(photograph.centre(), ray).second > (point - photograph.centre()).norm() - 0.02;
        }
        wrongly_seen += !visible;
        const Vec3 light = RoomScene::paint(1 + chart.face, point);
        double worst = 0;
        for (int k = 0; k < 3; ++k)
          worst = std::max(worst, std::abs(255 * srgb_from_linear(light[k]) - colour[k]));
        off += worst > 10;
      }
  }
  EXPECT_GT(seen, 20000u);
  EXPECT_GT(red, 100u);
  EXPECT_EQ(wrongly_seen, 0u);
  // Photographs blur the paint over their pixels, at corners across faces.
  EXPECT_LT(static_cast<double>(off) / static_cast<double>(seen), 0.02);
}

TEST(BakeAtlas, padding_continues_the_border_so_that_lookups_on_the_face_find_no_black) {
  RoomScene painted = room();
  for (Image8& image : painted.scene.photograph_pixels)
    std::fill(image.pixels.begin(), image.pixels.end(), std::uint8_t{128});
  Atlas atlas;
  const auto pages = bake(painted.scene, small_texels(), atlas);
  for (const auto& chart : atlas.charts) {
    const AtlasPage& page = pages[static_cast<std::size_t>(chart.page)];
    for (int row = -atlas.padding; row < chart.rows + atlas.padding; ++row)
      for (int col = -atlas.padding; col < chart.cols + atlas.padding; ++col) {
        // Grey, red, or the mean of both.
        const std::uint8_t* colour = page.colour.at(chart.x + col, chart.y + row);
        ASSERT_GE(colour[0], 126) << chart.face << " " << col << " " << row;
        ASSERT_EQ(colour[1], colour[2]);
      }
  }
}

TEST(BakeAtlas, has_the_same_bytes_for_any_tile) {
  Atlas first_plan, second_plan;
  const auto first = bake(room().scene, small_texels(), first_plan),
             second = bake(room().scene, small_texels(), second_plan, 37);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].colour.pixels, second[i].colour.pixels);
    EXPECT_EQ(first[i].coverage.pixels, second[i].coverage.pixels);
  }
}

TEST(BakeAtlas, texels_are_as_fine_as_the_photographs) {
  AtlasOptions options;
  stages::Renderer renderer(queue(), room().scene);
  const Atlas atlas = stages::plan_atlas(renderer, room().scene, options);
  options.texels_per_pixel = 2;
  const Atlas finer = stages::plan_atlas(renderer, room().scene, options);
  // The room is 3 to 6 m across and its photographs have 141 pixels per radian.
  ASSERT_EQ(atlas.charts.size(), finer.charts.size());
  std::size_t unseen = 0;
  for (std::size_t i = 0; i < atlas.charts.size(); ++i) {
    if (finer.charts[i].texel_m == atlas.charts[i].texel_m) {  // as coarse as it was looked at
      ++unseen;
      continue;
    }
    EXPECT_GT(atlas.charts[i].texel_m, 0.5 / 141);
    EXPECT_LT(atlas.charts[i].texel_m, 6.0 / 141);
    EXPECT_NEAR(finer.charts[i].texel_m, atlas.charts[i].texel_m / 2, 1e-9);
  }
  EXPECT_EQ(unseen, atlas.unseen_faces);
}

TEST(BakeAtlas, narrow_faces_are_seen) {
  // Bars 10 m long and from 20 cm down to 0.1 mm wide.
  stages::RenderScene scene;
  for (const double width : {0.2, 0.02, 0.002, 0.0001}) {
    const auto first = static_cast<std::uint32_t>(scene.proxy.vertices.size());
    const double z = static_cast<double>(first) / 8;
    for (const Vec3& corner : {Vec3(-5, 0, z), Vec3(5, 0, z), Vec3(5, 0, z + width), Vec3(-5, 0, z + width)})
      scene.proxy.vertices.push_back(corner);
    scene.proxy.faces.push_back({"bar", {first, first + 1, first + 2, first + 3}, {}});
  }
  scene.photographs.push_back(look_at({0, -8, 1}, {0, 0, 1}, {0, 0, 1}, 70, 200, 100));
  scene.photograph_pixels.emplace_back(200, 100, 3, std::uint8_t{99});
  Atlas atlas;
  const auto pages = bake(scene, {}, atlas);
  EXPECT_EQ(atlas.unseen_faces, 0u);
  ASSERT_EQ(atlas.charts.size(), 4u);
  for (const auto& chart : atlas.charts) {
    const std::uint8_t* colour = pages[0].colour.at(chart.x + chart.cols / 2, chart.y + chart.rows / 2);
    EXPECT_NEAR(colour[1], 99, 1) << chart.face;
  }
}

TEST(BakeAtlas, a_wall_seen_from_both_sides_has_two_charts) {
  stages::RenderScene scene;
  scene.proxy.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 0, 2}, {0, 0, 2}, {5, 5, 5}, {6, 5, 5}, {6, 6, 5}};
  scene.proxy.faces = {{"wall", {0, 1, 2, 3}, {}}, {"far away", {4, 5, 6}, {}}};
  for (const double side : {-3.0, 3.0}) {
    Photograph photograph = look_at({1, side, 1}, {1, 0, 1}, {0, 0, 1}, 50, 60, 60);
    photograph.name = side < 0 ? "front" : "back";
    scene.photographs.push_back(photograph);
    scene.photograph_pixels.emplace_back(60, 60, 3, static_cast<std::uint8_t>(side < 0 ? 200 : 60));
  }
  Atlas atlas;
  const auto pages = bake(scene, {}, atlas);
  ASSERT_EQ(atlas.charts.size(), 3u);
  EXPECT_FALSE(atlas.charts[0].back);
  EXPECT_TRUE(atlas.charts[1].back);
  EXPECT_EQ(atlas.unseen_faces, 1u);  // the other face: one red chart
  const auto middle = [&](const stages::AtlasChart& chart) {
    return pages[0].colour.at(chart.x + chart.cols / 2, chart.y + chart.rows / 2)[1];
  };
  EXPECT_NEAR(middle(atlas.charts[0]), 200, 1);
  EXPECT_NEAR(middle(atlas.charts[1]), 60, 1);
  EXPECT_EQ(pages[0].colour.at(atlas.charts[2].x, atlas.charts[2].y)[0], 255);
}

}  // namespace hybrid::testing::bake_atlas_test
