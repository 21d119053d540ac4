// What photographs see of a surface, and what hides it from a view.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cases/room_scene.hpp"
#include "stages/rendering/render_requests.hpp"

namespace hybrid::testing {
namespace {

using stages::RenderedView;
using stages::Renderer;
using stages::RenderOptions;
using stages::RenderScene;
using stages::ViewRequest;

// That meet the plane y = 0 in the origin at these angles.
void add_photographs(std::initializer_list<double> angles_deg, RenderScene& scene) {
  for (const double degrees : angles_deg) {
    const double angle = degrees * M_PI / 180;
    Photograph photograph =
        look_at(20 * Vec3(std::cos(angle), -std::sin(angle), 0), {0, 0, 0}, Vec3::UnitZ(), 60, 64, 48);
    photograph.name = std::to_string(degrees);
    scene.photographs.push_back(photograph);
    scene.photograph_pixels.emplace_back(64, 48, 3, std::uint8_t{128});
  }
}

}  // namespace

TEST(RenderSight, a_photograph_that_only_grazes_a_surface_does_not_see_it) {
  RenderScene scene;
  scene.proxy.vertices = {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}};
  scene.proxy.faces = {{"wall", {0, 1, 2, 3}, {}}};
  add_photographs({3, 8}, scene);
  for (const auto& [least_deg, seen] : {std::pair{0.0, 2u}, {5.0, 1u}, {10.0, 0u}}) {
    RenderOptions options;
    options.grazing_deg = least_deg;
    for (const char* weights : {"angle", "ulr"}) {  // kernels of their own
      options.weights = weights;
      const auto image = render(scene, view({0, -3, 0}, {0, 0, 0}, 9, 9), options);
      EXPECT_EQ(image.coverage[40], seen) << least_deg << weights;
      EXPECT_EQ(image.colour.pixels[3 * 40 + 1] == 0, seen == 0);  // red
    }
    Renderer renderer(queue(), scene, options);
    EXPECT_EQ(renderer.count_seen({{{0, 0, 0}, -Vec3::UnitY()}})[0], seen);
  }
}

TEST(RenderSight, of_samples_a_photograph_sees_nothing_at_angles_at_which_it_sees_faces) {
  RenderScene scene;
  scene.splats = {{{0, 0, 0}, 0.3f, {0, -1, 0}, 0}};
  add_photographs({4, 8, 40}, scene);
  for (const auto& [least_deg, sample_deg, seen] :
       {std::tuple{2.0, 0.0, 3u}, {2.0, 6.0, 2u}, {2.0, 10.0, 1u}, {10.0, 6.0, 1u}}) {
    RenderOptions options;
    options.grazing_deg = least_deg;
    options.grazing_sample_deg = sample_deg;
    for (const char* weights : {"angle", "ulr"}) {  // kernels of their own
      options.weights = weights;
      const auto image = render(scene, view({0, -3, 0}, {0, 0, 0}, 9, 9), options);
      EXPECT_EQ(image.coverage[40], seen) << least_deg << " " << sample_deg << weights;
    }
  }
}

TEST(RenderSight, camera_markers_hide_little_of_what_a_view_shows) {
  RenderScene scene = RoomScene::make(0, 64, 48).scene;
  scene.photographs = {look_at({3, 1.2, 1.5}, {3, 5, 1.5}, Vec3::UnitZ(), 65, 64, 48)};
  scene.photographs[0].name = "before-us";
  scene.photograph_pixels = {Image8(64, 48, 3, std::uint8_t{128})};
  ViewRequest request = view({3, 0.6, 1.5}, {3, 5, 1.5}, 160, 120);  // 60 cm behind it
  request.texture = false;
  request.cameras = true;
  const RenderedView image = render(scene, request);
  const auto hidden = std::count(image.id.begin(), image.id.end(), 0x40000000u);
  EXPECT_GT(hidden, 20);
  EXPECT_LT(hidden, 160 * 120 / 50);
}

}  // namespace hybrid::testing
