#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "io/cameras/colmap.hpp"
#include "io/cameras/read_cameras.hpp"
#include "io/colmap_bytes.hpp"
#include "io/files.hpp"

namespace hybrid::io::colmap_binary_test {
namespace {
using testing::bytes;
using testing::colmap_camera_bytes;
using testing::colmap_image_bytes;
using testing::error_of;
using testing::holds;
using testing::real_data;
using testing::TemporaryFolder;

const std::string kCameras =
    bytes(std::uint64_t{2}) + colmap_camera_bytes(7, 1, 640, 480, {500, 510, 320, 240}) +
    colmap_camera_bytes(9, 6, 64, 48, {50, 51, 32, 24, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8});
const std::string kImages = bytes(std::uint64_t{2}) + colmap_image_bytes(3, 7, "sub/b c.jpg", 2) +
                            colmap_image_bytes(4, 9, "a.jpg", 0);

CameraFile read(const TemporaryFolder& folder, const std::string& cameras, const std::string& images) {
  folder.write("cameras.bin", cameras);
  folder.write("images.bin", images);
  return read_colmap(folder.path());
}

TEST(colmap_binary, cameras_and_images) {
  const TemporaryFolder folder;
  const CameraFile file = read(folder, kCameras, kImages);
  ASSERT_EQ(file.cameras.size(), 2u);
  EXPECT_EQ(file.cameras[1].model, "FULL_OPENCV");
  const Camera& c = file.cameras[1].camera;
  EXPECT_EQ((std::vector<double>{c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6}),
            (std::vector<double>{50, 51, 32, 24, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}));
  ASSERT_EQ(file.photographs.size(), 2u);
  EXPECT_EQ(file.photographs[0].name, "a.jpg");
  EXPECT_EQ(file.photographs[1].name, "sub/b c.jpg");
  EXPECT_EQ(file.photographs[1].camera.fy, 510);
  EXPECT_EQ(file.photographs[1].cam_from_world.translation, Vec3(1, 2, 3));
}

TEST(colmap_binary, is_chosen_before_text) {
  const TemporaryFolder folder;
  folder.write("cameras.txt", "1 SIMPLE_PINHOLE 64 48 50 32 24\n");
  folder.write("images.txt", "1 1 0 0 0 1 2 3 1 text.jpg\n\n");
  EXPECT_EQ(read_colmap(folder.path()).photographs.at(0).name, "text.jpg");
  const CameraFile file = read(folder, kCameras, kImages);
  EXPECT_EQ(file.photographs.size(), 2u);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_TRUE(holds(file.notes[0], "the binary model was read"));
}

// Wherever either file ends too early (the steps meet every field), and with bytes to spare.
TEST(colmap_binary, every_wrong_length_is_an_error) {
  const TemporaryFolder folder;
  for (std::size_t length = 0; length < kCameras.size(); length += 7)
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read(folder, kCameras.substr(0, length), kImages); }),
                      "cameras.bin: byte "));
  for (std::size_t length = 0; length < kImages.size(); length += 7)
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read(folder, kCameras, kImages.substr(0, length)); }),
                      "images.bin: byte "));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read(folder, kCameras + "x", kImages); }),
                    "found 1 bytes more; the count is wrong"));
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read(folder, kCameras, kImages + "xy"); }),
                    "found 2 bytes more; the count is wrong"));
}

TEST(colmap_binary, errors_name_file_and_byte) {
  struct Case {
    std::string cameras, images, place, part;
  };
  const std::uint64_t one = 1, many = std::uint64_t{1} << 60;
  const auto camera = [&](std::int32_t model, std::uint64_t width, const std::vector<double>& parameters) {
    return bytes(one) + colmap_camera_bytes(7, model, width, 48, parameters);
  };
  const std::string good = camera(0, 64, {50, 32, 24});
  std::string turned = bytes(one) + colmap_image_bytes(3, 7, "a.jpg", 0);
  const double two = 2, infinite = INFINITY;
  std::string endless = turned;
  std::memcpy(turned.data() + 12, &two, 8);             // QW
  std::memcpy(endless.data() + 12 + 32, &infinite, 8);  // TX
  const std::vector<Case> cases = {
      {bytes(std::uint64_t{0}), "", "cameras.bin: byte 8", "at least one camera"},
      {bytes(many) + good.substr(8), "", "cameras.bin: byte 0", "expected 1152921504606846976 cameras"},
      {camera(7, 64, {1, 1, 1, 1, 1}), "", "cameras.bin: byte 8", "found FOV, which is not supported"},
      {camera(10, 64, {}), "", "cameras.bin: byte 8", "found THIN_PRISM_FISHEYE, which is not supported"},
      {camera(77, 64, {}), "", "cameras.bin: byte 8", "found number 77"},
      {camera(-1, 64, {}), "", "cameras.bin: byte 8", "found number -1"},
      {camera(0, many << 3, {50, 32, 24}), "", "cameras.bin: byte 8", "width: expected 1 to"},
      {camera(0, 0, {50, 32, 24}), "", "cameras.bin: byte 8", "width: expected 1 to"},
      {camera(0, 64, {NAN, 32, 24}), "", "cameras.bin: byte 32", "parameter 1 of 3 of SIMPLE_PINHOLE"},
      {camera(0, 64, {-5, 32, 24}), "", "cameras.bin: byte 8", "focal length"},
      {bytes(std::uint64_t{2}) + good.substr(8) + good.substr(8), "", "cameras.bin: byte 56",
       "camera id 7 occurs twice"},
      {good, bytes(std::uint64_t{0}), "images.bin: byte 8", "at least one image"},
      {good, bytes(many), "images.bin: byte 0", "images of at least"},
      {good, turned, "images.bin: byte 8", "expected a quaternion of length 1, found length 2"},
      {good, endless, "images.bin: byte 44", "TX: expected a finite number"},
      {good, bytes(one) + colmap_image_bytes(3, 8, "a.jpg", 0), "images.bin: byte 8",
       "expected one of the model's 1 cameras, found 8"},
      {good, bytes(one) + colmap_image_bytes(3, 7, "", 1), "images.bin: byte 8", "expected the image's name"},
      {good, kImages, "images.bin: byte ", "expected one of the model's 1 cameras, found 9"},
  };
  const TemporaryFolder folder;
  for (const auto& [cameras, images, place, part] : cases) {
    SCOPED_TRACE(part);
    const std::string message = error_of(
        ErrorKind::input, [&, cameras = cameras, images = images] { read(folder, cameras, images); });
    EXPECT_TRUE(holds(message, (folder.path() / place).string()));
    EXPECT_TRUE(holds(message, part));
  }
}

// Against an independent reading: the world's points of one camera land in its image where its keypoints are
// (points3D.bin and the keypoints are read here by hand).
TEST(colmap_binary, real_sceaux) {
  const auto folder = real_data("formats/colmap-sceaux-bin");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const CameraFile file = read_colmap(folder);
  EXPECT_EQ(find_cameras(folder)->format, CameraFormat::colmap);
  EXPECT_EQ(file.cameras.size(), 1u);
  ASSERT_EQ(file.photographs.size(), 11u);
  const auto errors = testing::colmap_binary_errors_px(folder, file.photographs);
  ASSERT_GT(errors.size(), 20000u);
  const double median = errors[errors.size() / 2];
  RecordProperty("median_px", std::to_string(median));
  EXPECT_LT(median, 0.6);
}

}  // namespace
}  // namespace hybrid::io::colmap_binary_test
