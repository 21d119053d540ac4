#include "stages/rendering/photograph_levels.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cases/room_scene.hpp"
#include "device.hpp"
#include "geometry/colour.hpp"

namespace hybrid::testing {
namespace {

// A checkered wall, cells of 1 cm, photographed from 1 m: from afar its squares are finer than a view's
// pixels.
stages::RenderScene checkered_wall() {
  RoomScene wall;
  wall.add_box({-1, 1, -1}, {1, 1.1, 1}, false);
  Photograph photograph = look_at({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 80, 512, 512);
  photograph.name = "near";
  wall.scene.photographs = {photograph};
  Image8 image(512, 512, 3);
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x) {
      const Vec3 direction =
          photograph.cam_from_world.rotation.conjugate() * photograph.camera.ray(Vec2(x + 0.5, y + 0.5));
      const Vec3 at = direction / direction.y();
      const bool white =
          (static_cast<int>(std::floor(at.x() * 100)) + static_cast<int>(std::floor(at.z() * 100))) % 2 == 0;
      std::fill_n(image.at(x, y), 3, white ? std::uint8_t{230} : std::uint8_t{20});
    }
  wall.scene.photograph_pixels = {image};
  return wall.scene;
}

stages::ViewRequest view_from(double distance_m) {
  stages::ViewRequest request;
  request.camera = look_at({0, 1 - distance_m, 0.03}, {0, 1, 0}, {0, 0, 1}, 10, 64, 64);
  return request;
}

std::vector<int> levels(const stages::RenderScene& scene, const stages::RenderOptions& options,
                        double distance_m) {
  stages::RenderState state(queue(), scene, options);
  return photograph_levels(state, state.geometry("both"), view_from(distance_m).camera);
}

}  // namespace

TEST(PhotographLevels, follow_how_much_finer_a_photograph_is_than_the_view) {
  const auto scene = checkered_wall();
  // A pixel of the photograph covers 3.3 mm of the wall, one of the view 2.7 mm per metre.
  EXPECT_EQ(levels(scene, {}, 1), std::vector<int>{0});
  EXPECT_EQ(levels(scene, {}, 3), std::vector<int>{1});
  EXPECT_EQ(levels(scene, {}, 12), std::vector<int>{2});  // its corners see the wall at a slant
  stages::RenderOptions finer;
  finer.samples_per_axis = 2;
  EXPECT_EQ(levels(scene, finer, 12), std::vector<int>{1});
  finer.levels = false;
  EXPECT_EQ(levels(scene, finer, 12), std::vector<int>{0});
}

TEST(PhotographLevels, what_is_finer_than_a_pixel_becomes_its_mean) {
  const auto scene = checkered_wall();
  const double mean = (linear_from_srgb(230 / 255.0) + linear_from_srgb(20 / 255.0)) / 2;
  const auto spread = [&](bool with_levels) {
    stages::RenderOptions options;
    options.levels = with_levels;
    options.blend = "linear";
    const auto view = stages::Renderer(queue(), scene, options).render(view_from(12));
    double sum = 0;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < view.coverage.size(); ++i) {
      if (view.coverage[i] == 0) continue;
      ++seen;
      const double off = static_cast<double>(view.colour.pixels[3 * i + 1]) - mean;
      sum += off * off;
    }
    EXPECT_GT(seen, 2000u);
    return std::sqrt(sum / static_cast<double>(seen));
  };
  // One pixel of the view spans 3.3 squares.
  EXPECT_LT(spread(true), 0.5 * spread(false));
}

TEST(PhotographLevels, half_an_image_is_the_mean_of_four_pixels_light) {
  Image8 image(3, 3, 4, 255);
  const std::uint8_t bytes[9] = {0, 255, 100, 255, 0, 200, 40, 60, 80};
  for (int i = 0; i < 9; ++i) std::fill_n(image.at(i % 3, i / 3), 3, bytes[i]);
  const Image8 half = stages::half_size(image);
  ASSERT_EQ(half.width, 2);
  ASSERT_EQ(half.height, 2);
  ASSERT_EQ(half.channels, 3);
  const auto light = [](int byte) { return linear_from_srgb(byte / 255.0); };
  EXPECT_EQ(half.at(0, 0)[0], srgb_byte_from_linear(0.5f));
  EXPECT_EQ(half.at(1, 0)[1], srgb_byte_from_linear(static_cast<float>((light(100) + light(200)) / 2)));
  EXPECT_EQ(half.at(1, 1)[2], 80);
}

TEST(PhotographLevels, a_halved_camera_sees_each_point_at_half_the_position) {
  Camera camera = RoomScene::make(1, 101, 64).scene.photographs[0].camera;
  const Camera quarter = stages::half_camera(camera, 2);
  EXPECT_EQ(quarter.width, 26);
  EXPECT_EQ(quarter.height, 16);
  const Vec3 point(0.2, -0.1, 1);
  EXPECT_LT((4 * *quarter.project(point) - *camera.project(point)).norm(), 1e-9);
}

TEST(PhotographLevels, photographs_decoded_again_and_again_give_the_same_view) {
  const RoomScene room = RoomScene::make(4, 120, 90);
  stages::RenderScene scene = room.scene;
  std::size_t decoded = 0;
  for (Image8& image : scene.photograph_pixels) image.pixels.clear();
  scene.decode = [&](std::size_t i) {
    ++decoded;
    return std::make_shared<const Image8>(room.scene.photograph_pixels[i]);
  };
  stages::ViewRequest request;
  request.camera = look_at({5.6, 4.6, 2.6}, {2, 1, 0}, {0, 0, 1}, 65, 80, 60);
  stages::RenderOptions options;
  options.tile = 32;
  options.equalise = true;
  const auto kept = stages::Renderer(queue(), room.scene, options).render(request);
  const auto again = stages::Renderer(queue(), scene, options).render(request);
  EXPECT_TRUE(same_bits(kept.colour.pixels, again.colour.pixels));
  EXPECT_EQ(kept.best, again.best);
  EXPECT_GE(decoded, 4u);
}

}  // namespace hybrid::testing
