#include "io/cameras/nerfstudio.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/cameras/read_cameras.hpp"
#include "io/files.hpp"
#include "io/picture.hpp"

namespace hybrid::io::nerfstudio_test {
namespace {
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

// At (1, 2, 3), looking along world +x with world z up: right is -y, up is z, back is -x.
const std::string kMatrix = "[[0,0,-1,1],[-1,0,0,2],[0,1,0,3],[0,0,0,1]]";

std::string frame(const std::string& path, const std::string& more = "") {
  return "{\"file_path\":\"" + path + "\",\"transform_matrix\":" + kMatrix + more + "}";
}
std::string document(const std::string& keys, const std::string& frames) {
  return "{" + keys + ",\n\"frames\":[" + frames + "]}";
}
const std::string kKeys = "\"w\":64,\"h\":48,\"fl_x\":100,\"fl_y\":110,\"cx\":31.5,\"cy\":23";

CameraFile read(const TemporaryFolder& folder, const std::string& text, bool sizes = false) {
  return read_nerfstudio(folder.write("transforms.json", text),
                         sizes ? folder.path() : std::filesystem::path());
}

TEST(nerfstudio, axes_and_intrinsics) {
  const TemporaryFolder folder;
  const CameraFile file =
      read(folder, document(kKeys, frame("images/b.jpg") + "," + frame("./images/a.jpg")));
  ASSERT_EQ(file.photographs.size(), 2u);
  const Photograph& photograph = file.photographs[0];
  EXPECT_EQ(photograph.name, "images/a.jpg");
  EXPECT_EQ(photograph.camera.width, 64);
  EXPECT_NEAR((photograph.centre() - Vec3(1, 2, 3)).norm(), 0, 1e-12);
  const auto project = [&](const Vec3& point) {
    return *photograph.camera.project(photograph.cam_from_world * point);
  };
  EXPECT_NEAR((project({11, 2, 3}) - Vec2(31.5, 23)).norm(), 0, 1e-9);
  EXPECT_NEAR((project({11, 1, 3}) - Vec2(41.5, 23)).norm(), 0, 1e-9);
  EXPECT_NEAR((project({11, 2, 4}) - Vec2(31.5, 12)).norm(), 0, 1e-9);
  EXPECT_EQ(file.cameras[0].model, "OPENCV");
}

TEST(nerfstudio, what_a_frame_says_wins) {
  const TemporaryFolder folder;
  const CameraFile file =
      read(folder, document(kKeys + ",\"k1\":0.1,\"k2\":0.2,\"k3\":0.3,\"p1\":0.4,\"p2\":0.5",
                            frame("a.jpg") + "," + frame("b.jpg", ",\"fl_x\":50,\"k1\":-0.1,\"w\":128")));
  const Camera &a = file.photographs[0].camera, &b = file.photographs[1].camera;
  EXPECT_EQ(a.fx, 100);
  EXPECT_EQ((std::vector<double>{a.k1, a.k2, a.k3, a.p1, a.p2}),
            (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(b.fx, 50);
  EXPECT_EQ(b.k1, -0.1);
  EXPECT_EQ(b.width, 128);
}

TEST(nerfstudio, fisheye) {
  const TemporaryFolder folder;
  for (const char* key : {",\"camera_model\":\"OPENCV_FISHEYE\"", ",\"is_fisheye\":true"}) {
    const CameraFile file =
        read(folder, document(kKeys + key + ",\"k1\":0.1,\"k4\":0.01,\"p1\":0", frame("a.jpg")));
    EXPECT_EQ(file.cameras[0].model, "OPENCV_FISHEYE");
    EXPECT_EQ(file.photographs[0].camera.lens, Lens::fisheye);
    EXPECT_EQ(file.photographs[0].camera.k4, 0.01);
  }
}

// Straight ahead is the middle of the picture, a quarter turn to the right three quarters along, the zenith
// on top.
TEST(nerfstudio, panoramas) {
  const TemporaryFolder folder;
  const CameraFile file = read(folder, document("\"w\":400,\"h\":200,\"fl_x\":7,\"cx\":3,\"camera_model\":"
                                                "\"EQUIRECTANGULAR\"",
                                                frame("a.jpg")));
  const Photograph& photograph = file.photographs.at(0);
  EXPECT_EQ(photograph.camera.lens, Lens::spherical);
  EXPECT_TRUE(photograph.camera.wraps());
  const auto project = [&](const Vec3& point) {
    return *photograph.camera.project(photograph.cam_from_world * point);
  };
  EXPECT_NEAR((project({11, 2, 3}) - Vec2(200, 100)).norm(), 0, 1e-9);
  EXPECT_NEAR((project({1, -8, 3}) - Vec2(300, 100)).norm(), 0, 1e-9);
  EXPECT_NEAR(project({1.001, 2, 9}).y(), 0, 0.1);
}

TEST(nerfstudio, what_was_applied_can_be_undone) {
  const TemporaryFolder folder;
  EXPECT_EQ(read(folder, document(kKeys, frame("a.jpg"))).frame_hint, "");
  const auto hint = [&](const std::string& matrix) {
    return read(folder, document(kKeys + ",\"applied_transform\":" + matrix, frame("a.jpg"))).frame_hint;
  };
  EXPECT_NE(
      hint("[[1,0,0,0],[0,0,1,2],[0,-1,0,-3]]").find("[1, 0, 0, 0, 0, 0, -1, -3, 0, 1, 0, -2, 0, 0, 0, 1]"),
      std::string::npos)
      << hint("[[1,0,0,0],[0,0,1,2],[0,-1,0,-3]]");
  EXPECT_EQ(hint("[[1,0,0,0],[0,1,0,0],[0,0,1,0]]"), "");  // nothing was
  for (const char* odd : {"7", "[1,2,3]", "[[1,0,0],[0,1,0],[0,0,1]]", "[[9,0,0,0],[0,1,0,0],[0,0,1,0]]"})
    EXPECT_EQ(hint(odd), "") << odd;
}

// Blender's sets: an angle instead of a focal length, no size, no ending.
TEST(nerfstudio, angle_and_size_of_the_picture) {
  const TemporaryFolder folder;
  write_png(folder.path() / "train/r_0.png", Image8(80, 60, 3));
  const std::string text = document("\"camera_angle_x\":0.6911112070083618", frame("./train/r_0"));
  const Photograph photograph = read(folder, text, true).photographs[0];
  EXPECT_EQ(photograph.name, "train/r_0.png");
  EXPECT_EQ(photograph.camera.width, 80);
  EXPECT_EQ(photograph.camera.cx, 40);
  EXPECT_EQ(photograph.camera.cy, 30);
  EXPECT_NEAR(photograph.camera.fx, 40 / std::tan(0.6911112070083618 / 2), 1e-12);
  EXPECT_EQ(photograph.camera.fy, photograph.camera.fx);
  EXPECT_EQ(read(folder, text, false).photographs[0].camera.width, 0);
}

TEST(nerfstudio, errors_name_file_and_entry) {
  struct Case {
    std::string text, place, part;
  };
  const auto with_matrix = [](const std::string& matrix) {
    return document(kKeys, "{\"file_path\":\"a.jpg\",\"transform_matrix\":" + matrix + "}");
  };
  const std::string first = "transforms.json: frames[0]";
  const std::vector<Case> cases = {
      {"", "transforms.json:1", "no valid JSON"},
      {"{\n\"w\": 5,\n]}", "transforms.json:3", "no valid JSON"},
      {"[]", "transforms.json:1", "expected an object with a list of frames"},
      {"{\"frames\":[]}", "transforms.json:1", "expected an object with a list of frames"},
      {document(kKeys, "7"), first, "expected an object, found 7"},
      {document(kKeys, "{}"), first, "expected a file_path"},
      {document(kKeys, "{\"file_path\":7}"), first, "file_path: expected a string, found 7"},
      {document(kKeys, "{\"file_path\":\"a.jpg\"}"), first, "expected 4 rows of 4 numbers, found none"},
      {with_matrix("[[1,0,0,0],[0,1,0,0]]"), first, "expected 4 rows of 4 numbers"},
      {with_matrix("[[1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), first, "row 1: expected 4 numbers"},
      {with_matrix("[[1,0,0,\"x\"],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), first, "row 1: expected finite numbers"},
      {with_matrix("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]"), first, "the last row 0 0 0 1"},
      {with_matrix("[[1,0.1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), first, "expected a rotation"},
      {with_matrix("[[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), first, "found a mirrored one"},
      {document("\"w\":64,\"h\":48", frame("a.jpg")), first, "expected fl_x (pixels) or camera_angle_x"},
      {document("\"fl_x\":0", frame("a.jpg")), first, "focal length"},
      {document("\"fl_x\":\"x\"", frame("a.jpg")), first, "fl_x: expected a finite number"},
      {document("\"w\":64,\"h\":48,\"camera_angle_x\":3.2", frame("a.jpg")), first, "camera_angle_x"},
      {document(kKeys, frame("a.jpg", ",\"w\":64.5")), first, "w: expected a whole number"},
      {document(kKeys, frame("a.jpg", ",\"h\":-1")), first, "h: expected 1 to"},
      {document(kKeys + ",\"k4\":0.1", frame("a.jpg")), first, "k4: expected 0 with camera_model OPENCV"},
      {document(kKeys + ",\"camera_model\":\"VR180_L\"", frame("a.jpg")), first, "found VR180_L"},
      {document(kKeys + ",\"camera_model\":\"EQUIRECTANGULAR\",\"k1\":0.1", frame("a.jpg")), first,
       "k1: expected 0 with camera_model EQUIRECTANGULAR"},
      {document(kKeys, frame("a.jpg") + "," + frame("./a.jpg")), "transforms.json",
       "photograph a.jpg occurs twice"},
  };
  const TemporaryFolder folder;
  for (const auto& [text, place, part] : cases) {
    SCOPED_TRACE(text);
    const std::string message = error_of(ErrorKind::input, [&, text = text] { read(folder, text); });
    EXPECT_TRUE(holds(message, (folder.path() / place).string() + ": "));
    EXPECT_TRUE(holds(message, part));
  }
}

}  // namespace
}  // namespace hybrid::io::nerfstudio_test
