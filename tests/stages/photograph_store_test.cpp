#include "stages/photograph_store.hpp"

#include <gtest/gtest.h>

#include "cases/room_scene.hpp"
#include "device.hpp"
#include "stages/render_geometry.hpp"

namespace hybrid::testing {

TEST(PhotographStore, gives_the_same_photographs_whether_they_stay_or_are_loaded_again) {
  const RoomScene room = RoomScene::make(3, 40, 30);
  const auto geometry = stages::make_render_geometry(queue(), room.scene, "both", Vec3::Zero());
  stages::PhotographStore all(queue(), room.scene, {}, Vec3::Zero(), true);
  // Room for one photograph of 40 x 30 pixels with its low band.
  stages::PhotographStore one(queue(), room.scene, {}, Vec3::Zero(), true, 40 * 30 * 12);
  for (int round = 0; round < 2; ++round)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& entry = one.get(i, geometry);
      EXPECT_TRUE(same_bits(queue().read(entry.pixels), queue().read(all.get(i, geometry).pixels)));
      EXPECT_TRUE(same_bits(queue().read(entry.low), queue().read(all.get(i, geometry).low)));
    }
  EXPECT_NE(&one.get(0, geometry), &one.get(1, geometry));
  EXPECT_EQ(&one.get(1, geometry), &one.get(2, geometry));  // the visitors' place
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
