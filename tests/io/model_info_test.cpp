#include "io/models/model_info.hpp"

#include <gtest/gtest.h>

#include "io/cameras/colmap.hpp"
#include "io/files.hpp"
#include "io/models/obj.hpp"

namespace hybrid::io {
namespace {
using testing::real_data;
using testing::TemporaryFolder;

TEST(model_info, faces_areas_and_extents) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("model.obj",
                   "v 0 0 0\nv 4 0 0\nv 4 0 3\nv 0 0 3\nv 1 0 1\nv 2 0 1\nv 2 0 2\nv 1 0 2\nv -1 5 0.5\n"
                   "g wall\nf 1 5 8 7 6 5 1 2 3 4\n"  // a window as a keyhole
                   "g flat\nf 1 5 7\n");              // three vertices on one line
  const ModelInfo info = describe_model(read_obj(file));
  EXPECT_EQ(info.vertices, 9u);
  ASSERT_EQ(info.faces.size(), 2u);
  EXPECT_EQ(info.faces[0].name, "wall");
  EXPECT_EQ(info.faces[0].vertices, 4u);
  EXPECT_EQ(info.faces[0].holes, 1u);
  EXPECT_DOUBLE_EQ(info.faces[0].area_m2, 11);
  EXPECT_EQ(info.faces[0].problem, "");
  EXPECT_EQ(info.faces[1].area_m2, 0);
  EXPECT_TRUE(testing::holds(info.faces[1].problem, "face flat"));
  EXPECT_DOUBLE_EQ(info.area_m2, 11);
  EXPECT_EQ(info.minimum, Vec3(-1, 0, 0));
  EXPECT_EQ(info.maximum, Vec3(4, 5, 3));
}

TEST(model_info, faces_that_are_not_flat_say_so) {
  const TemporaryFolder folder;
  const auto file = folder.write("model.obj", "v 0 0 0.1\nv 1 0 -0.1\nv 1 1 0.1\nv 0 1 -0.1\nf 1 2 3 4\n");
  EXPECT_NEAR(describe_model(read_obj(file)).faces[0].off_plane_m, 0.1, 1e-12);
}

TEST(model_info, cameras_and_photographs) {
  const TemporaryFolder folder;
  folder.write("cameras.txt", "1 PINHOLE 640 480 500 510 320 240\n2 SIMPLE_RADIAL 64 48 50 32 24 0.1\n");
  folder.write("images.txt", "1 1 0 0 0 -1 -2 -3 1 b.jpg\n\n2 1 0 0 0 -4 1 0 1 a.jpg\n\n");
  const CameraFile cameras = read_colmap(folder.path());
  ASSERT_EQ(cameras.cameras.size(), 2u);
  EXPECT_EQ(cameras.cameras[1].model, "SIMPLE_RADIAL");  // listed though no photograph uses it
  ASSERT_EQ(cameras.photographs.size(), 2u);
  EXPECT_EQ(cameras.photographs[0].name, "a.jpg");
  EXPECT_EQ(cameras.photographs[0].camera.width, 640);
  EXPECT_EQ(cameras.photographs[1].centre(), Vec3(1, 2, 3));
  const CentreBox box = box_of_centres(cameras.photographs);
  EXPECT_EQ(box.minimum, Vec3(1, -1, 0));
  EXPECT_EQ(box.maximum, Vec3(4, 2, 3));
}

TEST(model_info, real_box) {
  const auto file = real_data("formats/pdal/obj/box.obj");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  const ModelInfo info = describe_model(read_obj(file));
  EXPECT_DOUBLE_EQ(info.area_m2, 6);
  EXPECT_EQ(info.minimum, Vec3(-0.5, -0.5, -0.5));
  EXPECT_EQ(info.maximum, Vec3(0.5, 0.5, 0.5));
}

}  // namespace
}  // namespace hybrid::io
