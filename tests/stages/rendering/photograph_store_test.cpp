#include "stages/rendering/photograph_store.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "cases/room_scene.hpp"
#include "device.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::testing {

TEST(PhotographStore, gives_the_same_photographs_whether_they_stay_or_are_loaded_again) {
  const RoomScene room = RoomScene::make(3, 40, 30);
  const auto geometry = stages::make_render_geometry(queue(), room.scene, "both", Vec3::Zero());
  const stages::RenderOptions options{.blend = "dual"};  // has a low band
  stages::PhotographStore all(queue(), room.scene, options, Vec3::Zero(), true);
  // Room for one photograph of 40 x 30 pixels with its low band.
  stages::PhotographStore one(queue(), room.scene, options, Vec3::Zero(), true, 40 * 30 * 12);
  for (int round = 0; round < 2; ++round)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& entry = one.get(i, geometry);
      EXPECT_TRUE(same_bits(queue().read(entry.pixels), queue().read(all.get(i, geometry).pixels)));
      EXPECT_TRUE(same_bits(queue().read(entry.low), queue().read(all.get(i, geometry).low)));
    }
  for (auto* store : {&all, &one}) store->use_levels({1, 0, 2});
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(same_bits(queue().read(one.get(i, geometry).low), queue().read(all.get(i, geometry).low)));
  EXPECT_EQ(one.get(2, geometry).camera.width, 10u);
  EXPECT_EQ(queue().read(one.get(2, geometry).pixels).size(), 4u * 10 * 8);
  for (auto* store : {&all, &one}) store->use_levels({});
  one.get(0, geometry);  // the first to be asked for is the one that stays
  EXPECT_NE(&one.get(0, geometry), &one.get(1, geometry));
  EXPECT_EQ(&one.get(1, geometry), &one.get(2, geometry));  // the visitors' place
}

TEST(PhotographStore, no_low_band_crosses_a_visibility_edge) {
  // A black box before a white wall, its edges oblique in the picture: wherever the photograph shows one of
  // the two alone, so does its low band.
  RoomScene room;
  room.add_box({-4, 3, -4}, {4, 3.1, 4}, false);
  room.add_box({-0.7, 1.5, -0.5}, {0.4, 1.9, 0.6}, false);
  Photograph photograph = look_at({0.3, -2, 0.4}, {0, 2, 0}, {0.3, 0, 1}, 50, 120, 90);
  photograph.name = "edges";
  room.scene.photographs = {photograph};
  Image8 image(120, 90, 3);
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) {
      const Vec3 direction =
          photograph.cam_from_world.rotation.conjugate() * photograph.camera.ray(Vec2(x + 0.5, y + 0.5));
      const bool wall = room.hit(photograph.centre(), direction).first <= 6;
      std::fill_n(image.at(x, y), 3, wall ? std::uint8_t{255} : std::uint8_t{0});
    }
  room.scene.photograph_pixels = {image};
  const auto geometry = stages::make_render_geometry(queue(), room.scene, "both", Vec3::Zero());
  const stages::RenderOptions options{.blend = "dual", .sigma_px = 6};
  stages::PhotographStore store(queue(), room.scene, options, Vec3::Zero(), true);
  const auto low = queue().read(store.get(0, geometry).low);
  std::size_t black = 0, wrong = 0;
  for (std::size_t i = 0; i < low.size() / 4; ++i) {
    const float value = static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(low[4 * i]));
    const bool white = image.pixels[3 * i] == 255;
    black += !white;
    wrong += value != (white ? 1.0f : 0.0f);
  }
  EXPECT_GT(black, 500u);
  EXPECT_EQ(wrong, 0u);
}

TEST(PhotographStore, keeps_every_byte_of_rgb_and_rgba_images) {
  RoomScene room = RoomScene::make(2, 24, 18);
  Image8 with_alpha(24, 18, 4, 7);
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 24; ++x)
      std::copy_n(room.scene.photograph_pixels[0].at(x, y), 3, with_alpha.at(x, y));
  room.scene.photograph_pixels[1] = with_alpha;
  stages::PhotographStore store(queue(), room.scene, {}, Vec3::Zero(), false);
  const stages::DeviceBvh nothing = stages::upload_bvh(queue(), {}, {});
  EXPECT_TRUE(
      same_bits(queue().read(store.get(0, nothing).pixels), queue().read(store.get(1, nothing).pixels)));
  EXPECT_EQ(queue().read(store.get(0, nothing).pixels)[4 * 25 + 2],
            room.scene.photograph_pixels[0].at(1, 1)[2]);
}

}  // namespace hybrid::testing
