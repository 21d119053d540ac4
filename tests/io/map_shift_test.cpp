// A global shift: what is of the map loses it, what is near the origin does not.
#include "io/scene/map_shift.hpp"

#include <gtest/gtest.h>

#include "files.hpp"

namespace hybrid::io::map_shift_test {
namespace {

using testing::TemporaryFolder;

const Vec3 kShift(530000, 180000, 12.5);

SceneFile scene_of(const TemporaryFolder& folder, const std::string& shift) {
  return read_scene_file(folder.write("scene.toml", R"([scene]
shift = )" + shift + R"(
[[scan]]
file = "a.ply"
landmarks = [
  { scan = [530001, 180000, 12], model = [530001, 180002, 15.5] },
  { scan = [1, 2, 3], model = [1, 2, 3], snap = false },
]
[model]
file = "m.obj"
[photographs]
colmap = "c"
images = "i"
landmarks = [{ photograph = "a", model = [530003, 180004, 17.5] }]
[edit]
holes = [{ face = 0, world = [[530000, 180000, 12.5], [530001, 180000, 12.5], [530001, 180000, 13.5]] }]
[[edit.clip]]
keep = "inside"
box = [529990, 179990, 2.5, 530010, 180020, 32.5]
[[edit.clip]]
keep = "inside"
box = [-10, -10, -10, 10, 20, 20]
[[edit.clip]]
keep = "outside"
plane = [1, 0, 0, 530004]
[[edit.clip]]
keep = "outside"
plane = [0, 0, 1, 14]
[[edit.clip]]
keep = "outside"
prism = [[530000, 180000], [530001, 180000], [530001, 180001]]
z = [12.5, 22.5]
[[view]]
name = "v"
eye = [530000, 179990, 14.5]
target = [0, 0, 2]
size = [8, 8]
)"));
}

}  // namespace

TEST(MapShift, is_taken_off_what_is_nearer_to_it_than_to_the_origin) {
  const TemporaryFolder folder;
  const SceneFile scene = scene_of(folder, "[530000, 180000, 12.5]");
  const auto& picks = scene.scans[0].landmarks;
  EXPECT_EQ(*picks[0].model, Vec3(1, 2, 3));
  EXPECT_EQ(*picks[0].scan, Vec3(530001, 180000, 12)) << "a scan's own coordinates are none of the world's";
  EXPECT_EQ(*picks[1].model, Vec3(1, 2, 3));
  EXPECT_EQ(*scene.photographs->landmarks[0].model, Vec3(3, 4, 5));
  EXPECT_EQ(scene.edits.holes[0].world[2], Vec3(1, 0, 1));
  ASSERT_EQ(scene.edits.clips.size(), 5u);
  for (const std::size_t i : {0, 1}) {
    const auto& box = std::get<SceneClip::Box>(scene.edits.clips[i].shape);
    EXPECT_EQ(box.low, Vec3(-10, -10, -10));
    EXPECT_EQ(box.high, Vec3(10, 20, 20));
  }
  EXPECT_EQ(std::get<SceneClip::HalfSpace>(scene.edits.clips[2].shape).offset_m, 4);
  EXPECT_EQ(std::get<SceneClip::HalfSpace>(scene.edits.clips[3].shape).offset_m, 14)
      << "of heights nobody can tell";
  const auto& prism = std::get<SceneClip::Prism>(scene.edits.clips[4].shape);
  EXPECT_EQ(prism.polygon[2], Vec2(1, 1));
  EXPECT_EQ(prism.low, 0);
  EXPECT_EQ(prism.high, 10);
  EXPECT_EQ(scene.views[0].eye, Vec3(0, -10, 2));
  EXPECT_EQ(scene.views[0].target, Vec3(0, 0, 2));
  EXPECT_EQ(scene.model->shift, kShift);
  EXPECT_EQ(scene.photographs->shift, kShift);
}

TEST(MapShift, below_a_kilometre_nothing_is_taken_off) {
  const TemporaryFolder folder;
  const SceneFile scene = scene_of(folder, "[600, 700, 0]");
  EXPECT_EQ(scene.scans[0].landmarks[0].model, Vec3(530001, 180002, 15.5));
  EXPECT_FALSE(is_on_map({600, 700, 1}, scene.shift));
  EXPECT_TRUE(is_on_map({600, 900, 1}, {600, 900, 0}));
}

TEST(MapShift, a_model_and_cameras_of_the_map_come_to_the_origin) {
  PolygonModel model;
  model.vertices = {kShift, kShift + Vec3(3, 0, 0), kShift + Vec3(3, 4, 5)};
  EXPECT_TRUE(take_off_shift(kShift, model));
  EXPECT_EQ(model.vertices[2], Vec3(3, 4, 5));
  EXPECT_FALSE(take_off_shift(kShift, model));
  EXPECT_EQ(model.vertices[2], Vec3(3, 4, 5));

  const Photograph local = look_at({1, -9, 2}, {0, 0, 2}, Vec3::UnitZ(), 60, 40, 30);
  const Photograph far = look_at(kShift + Vec3(1, -9, 2), kShift + Vec3(0, 0, 2), Vec3::UnitZ(), 60, 40, 30);
  std::vector<Photograph> cameras = {local, far};
  take_off_shift(kShift, cameras);
  for (const Photograph& camera : cameras) {
    EXPECT_LT((camera.centre() - Vec3(1, -9, 2)).norm(), 1e-9);
    EXPECT_LT((*camera.camera.project(camera.cam_from_world * Vec3(0, 0, 2)) - Vec2(20, 15)).norm(), 1e-6);
  }
}

}  // namespace hybrid::io::map_shift_test
