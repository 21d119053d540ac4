#include <gtest/gtest.h>

#include <algorithm>

#include "cases/room_scene.hpp"
#include "stages/rendering/render_requests.hpp"

namespace hybrid::testing {

// An empty box from inside: every ray ends where the box does, and all photographs' colours show.
TEST(RenderPanorama, sees_all_around) {
  RoomScene box;
  const Vec3 size(6, 5, 3), eye(2, 1.5, 1.2);
  box.add_box({0, 0, 0}, size, true);
  stages::ViewRequest request;
  request.camera = look_around(eye, {5, 4, 2}, {0, 0, 1}, 96, 48);
  request.texture = false;
  const auto image = render(box.scene, request);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 96; ++x) {
      const Vec3 ray = request.camera.cam_from_world.rotation.conjugate() *
                       request.camera.camera.ray(Vec2(x + 0.5, y + 0.5));
      double range = 1e9;
      for (int axis = 0; axis < 3; ++axis)
        range = std::min(range, ((ray[axis] > 0 ? size[axis] : 0) - eye[axis]) / ray[axis]);
      EXPECT_NEAR(image.depth_m[static_cast<std::size_t>(y * 96 + x)], range, 1e-4 * range) << x << " " << y;
    }
  const RoomScene room = RoomScene::make(4, 240, 180);
  request.camera = look_around({1, 4, 1.5}, {3, 2.5, 1}, {0, 0, 1}, 96, 48);
  request.texture = true;
  const auto seen = render(room.scene, request).coverage;
  EXPECT_GT(std::count_if(seen.begin(), seen.end(), [](auto photographs) { return photographs > 0; }),
            96 * 48 / 2);
}

}  // namespace hybrid::testing
