#include "stages/rendering/free_space.hpp"

#include <gtest/gtest.h>

#include "cases/room_scene.hpp"
#include "device.hpp"

namespace hybrid::testing {

TEST(FreeSpace, is_what_a_scanner_or_a_photograph_has_in_sight) {
  RoomScene room = RoomScene::make(1, 40, 30);  // from (0.6, 0.5, 1.6)
  const std::vector<Vec3> places = {
      {1.5, 1, 1.5},    // in the room
      {-1, 1, 1.5},     // outside
      {0.1, 1, 1.5},    // 10 cm before a wall
      {2.5, 2.5, 0.6},  // inside a block
      {5.4, 2.2, 0.6},  // behind one
      {5.4, 2.2, 2.6},  // above it
  };
  stages::Renderer renderer(queue(), room.scene);
  EXPECT_EQ(stages::in_free_space(renderer, room.scene, places, 0.3),
            (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 1}));
  EXPECT_EQ(stages::in_free_space(renderer, room.scene, places, 0.05)[2], 1);
  room.scene.scanners = {{5.4, 4.5, 1.5}};
  EXPECT_EQ(stages::in_free_space(renderer, room.scene, places, 0.3),
            (std::vector<std::uint8_t>{1, 0, 0, 0, 1, 1}));
}

}  // namespace hybrid::testing
