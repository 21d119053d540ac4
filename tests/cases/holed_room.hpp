#pragma once
#include "cases/room_scene.hpp"

namespace hybrid::testing {

// The painted room with two holes in its wall x = 0, one of them no rectangle, and a few samples in the air.
inline RoomScene holed_room(int photographs, int width, int height) {
  RoomScene room;
  room.add_box({0, 0, 0}, {6, 5, 3}, true);
  auto& proxy = room.scene.proxy;
  const auto add_hole = [&](std::size_t face, std::initializer_list<Vec3> corners) {
    std::vector<std::uint32_t> ring;
    for (const Vec3& corner : corners) {
      ring.push_back(static_cast<std::uint32_t>(proxy.vertices.size()));
      proxy.vertices.push_back(corner);
    }
    proxy.faces[face].holes.push_back(ring);
  };
  add_hole(4, {{0, 1, 1}, {0, 1, 2}, {0, 2, 2}, {0, 2, 1}});
  add_hole(4, {{0, 3, 0.5}, {0, 3.5, 2.5}, {0, 4, 0.5}});
  room.refresh();
  const RoomScene whole = RoomScene::make(photographs, 1, 1);  // for its cameras
  room.add_box({2, 2, 0}, {3, 3, 1.2}, false);
  for (const Photograph& camera : whole.scene.photographs) {
    const Pose world_from_cam = camera.cam_from_world.inverse();
    room.add_photograph(world_from_cam.translation, world_from_cam * Vec3(0, 0, 1), width, height);
  }
  for (int i = 0; i < 40; ++i) {
    const float along = static_cast<float>(i);
    room.scene.splats.push_back(
        {{1.0f + 0.1f * along, 3.6f + 0.5f * std::sin(along), 1.0f + 0.3f * std::cos(2 * along)},
         0.03f + 0.001f * along,
         {0, 0, 0},  // spheres: with a normal they would be flat patches to the ray caster
         0});
  }
  return room;
}

}  // namespace hybrid::testing
