#include <gtest/gtest.h>

#include <limits>

#include "cases/room_scene.hpp"
#include "core/error.hpp"
#include "device.hpp"
#include "geometry/vectors.hpp"

namespace hybrid::testing::render_bad_input_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

stages::ViewRequest view(const Vec3& eye, const Vec3& target) {
  stages::ViewRequest request;
  request.camera = look_at(eye, target, {0, 0, 1}, 65, 60, 40);
  return request;
}

stages::RenderedView render(const stages::RenderScene& scene, const stages::ViewRequest& request) {
  return stages::Renderer(queue(), scene).render(request);
}

}  // namespace

TEST(RenderBadInput, a_camera_with_everything_behind_it_sees_nothing) {
  const RoomScene room = RoomScene::make(2, 60, 40);
  const auto image = render(room.scene, view({20, 2, 1}, {30, 2, 1}));
  for (std::size_t i = 0; i < image.id.size(); ++i) {
    EXPECT_EQ(image.id[i] + image.coverage[i], 0u);
    EXPECT_EQ(image.best[i], -1);
    EXPECT_TRUE(std::isinf(image.depth_m[i]));
    EXPECT_EQ(image.colour.pixels[3 * i], 0);
  }
}

TEST(RenderBadInput, a_view_without_pixels_is_refused_by_name) {
  const RoomScene room = RoomScene::make(2, 60, 40);
  for (const auto& [width, height] : {std::pair(0, 40), std::pair(60, 0), std::pair(-3, -3)}) {
    auto request = view({1, 1, 1}, {2, 2, 1});
    request.camera.name = "empty";
    request.camera.camera.width = width, request.camera.camera.height = height;
    try {
      render(room.scene, request);
      ADD_FAILURE() << width << " x " << height;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(
          std::string(error.what())
              .find(fmt::format("view empty: expected at least 1 x 1 pixels, found {} x {}", width, height)),
          std::string::npos)
          << error.what();
    }
  }
}

TEST(RenderBadInput, splats_that_are_no_numbers_are_not_drawn_and_normals_that_are_none_are_unknown) {
  stages::RenderScene scene = RoomScene::make(2, 60, 40).scene;
  const auto request = view({2, 2.5, 1.8}, {0, 2.5, 1.8});
  const std::array<float, 3> place{1, 2.5f, 1.8f}, towards{1, 0, 0};
  for (const stages::Splat& bad :
       {stages::Splat{{kNaN, 2.5f, 1.8f}, 0.1f, towards, 0},
        stages::Splat{{1, kInfinity, 1.8f}, 0.1f, towards, 0}, stages::Splat{place, kNaN, towards, 0},
        stages::Splat{place, kInfinity, towards, 0}, stages::Splat{place, 0, towards, 0},
        stages::Splat{place, -0.1f, towards, 0}})
    scene.splats.push_back(bad);
  for (std::uint32_t id : render(scene, request).id) EXPECT_LT(id, 0x80000000u);

  scene.splats.push_back({place, 0.1f, {kNaN, 0, 1}, 0});
  const auto odd = render(scene, request);
  scene.splats.back().normal = {0, 0, 0};
  const auto none = render(scene, request);
  EXPECT_GT(std::count(odd.id.begin(), odd.id.end(), 0x80000006u), 10);
  EXPECT_EQ(odd.id, none.id);
  EXPECT_TRUE(same_bits(odd.normal.pixels, none.normal.pixels));
  EXPECT_TRUE(same_bits(odd.colour.pixels, none.colour.pixels));
}

}  // namespace hybrid::testing::render_bad_input_test
