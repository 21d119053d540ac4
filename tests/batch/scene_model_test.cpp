// Faces of a scene's model that cannot be used: found when it is read, by file and line.
#include "batch/scene_model.hpp"

#include <gtest/gtest.h>

#include "../io/files.hpp"

namespace hybrid::batch::scene_model_test {
namespace {

using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

const std::string kVertices =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"  // a square
    "v 2 0 0\nv 3 0 0\n";                   // on a line with its first two

struct Read {
  PolygonModel model;
  std::vector<io::ObjFaceNames> names;
  io::SceneFile::Model section;
};

Read read(const TemporaryFolder& folder, const std::string& faces) {
  Read read;
  read.section.file = folder.write("model.obj", kVertices + faces);
  read.model = read_scene_model(read.section, read.names);
  return read;
}

}  // namespace

TEST(SceneModel, faces_without_area_are_left_out_and_the_others_keep_their_names) {
  const TemporaryFolder folder;
  ::testing::internal::CaptureStderr();
  const auto [model, names, section] = read(folder,
                                            "f 1 2 5\n"           // on a line
                                            "f 1 2 3\n"           //
                                            "g bow\nf 1 3 2 4\n"  // its halves cancel
                                            "g wall\nf 1 2 3 4\n"
                                            "g\nf 2 5 6\nf 1 5 6\nf 3 4 1\n");
  const std::string warning = ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(holds(warning,
                    "model.obj: 4 of 7 faces have no area and are left out (line 7, face face-0: 3 "
                    "vertices on one point or line; line 10, face bow: its outline crosses itself, "
                    "the areas of its parts cancel; line 14, face face-4: 3 vertices on one point or "
                    "line; ...); correct or remove them in the model"));
  ASSERT_EQ(model.faces.size(), 3u);
  EXPECT_EQ(model.faces[0].name, "face-1");
  EXPECT_EQ(model.faces[1].name, "wall");
  EXPECT_EQ(model.faces[2].name, "face-6");
  ASSERT_EQ(names.size(), 3u);
  EXPECT_EQ(names[1].group, "wall");
  EXPECT_EQ(names[2].place, 6u);
  EXPECT_EQ(names[2].line, 16u);
}

TEST(SceneModel, without_any_face_that_has_an_area_is_an_error) {
  const TemporaryFolder folder;
  const auto error = error_of(ErrorKind::input, [&] { read(folder, "f 1 2 5\nf 2 5 6\n"); });
  EXPECT_TRUE(holds(error, "model.obj: expected faces with an area, found 2 without (line 7, face face-0: "));
}

TEST(SceneModel, a_vertex_beyond_all_measure_is_told_by_the_line_of_its_face) {
  const TemporaryFolder folder;
  const auto error = error_of(ErrorKind::input, [&] { read(folder, "f 1 2 3\nv 1 1e308 3\nf 1 2 7\n"); });
  EXPECT_TRUE(holds(error,
                    "model.obj:9: face face-1: vertex 7: expected coordinates within 1e+09 m, found 1 "
                    "1e+308 3; "));
}

TEST(SceneModel, an_outline_that_crosses_itself_is_told_by_its_line) {
  const TemporaryFolder folder;
  const auto [model, names, section] = read(folder, "f 1 2 3\nv 3 4 0\ng star\nf 1 7 2 4\n");
  const auto error = error_of(ErrorKind::input, [&] { check_outlines(section, model, names, model); });
  EXPECT_TRUE(holds(error, "model.obj:10: face star: expected a simple outline"));
}

}  // namespace hybrid::batch::scene_model_test
