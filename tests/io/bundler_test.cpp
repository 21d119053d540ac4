#include "io/cameras/bundler.hpp"

#include <gtest/gtest.h>

#include "io/cameras/read_cameras.hpp"
#include "io/files.hpp"
#include "io/picture.hpp"

namespace hybrid::io::bundler_test {
namespace {
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

const std::string kTitle = "# Bundle file v0.3\n";
// At (0, 0, 5), looking along world -z with world y up: Bundler's own axes are the world's.
const std::string kCamera = "100 0.1 0.01\n1 0 0\n0 1 0\n0 0 1\n0 0 -5\n";
const std::string kNone = "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n";
const std::string kPoint = "1 2 3\n255 128 0\n2 0 17 1.5 -2.5 1 4 0 0\n";

CameraFile read(const TemporaryFolder& folder, const std::string& bundle, const std::string& list,
                bool sizes = true) {
  folder.write("list.txt", list);
  return read_bundler(folder.write("bundle.out", bundle),
                      sizes ? folder.path() / "images" : std::filesystem::path());
}

void write_picture(const TemporaryFolder& folder, const std::string& name) {
  write_png(folder.path() / "images" / name, Image8(64, 48, 3));
}

TEST(bundler, axes_centre_and_distortion) {
  const TemporaryFolder folder;
  write_picture(folder, "a.png");
  const CameraFile file = read(folder, kTitle + "1 1\n" + kCamera + kPoint, "./a.png\n");
  ASSERT_EQ(file.photographs.size(), 1u);
  const Photograph& photograph = file.photographs[0];
  EXPECT_EQ(photograph.name, "a.png");
  EXPECT_NEAR((photograph.centre() - Vec3(0, 0, 5)).norm(), 0, 1e-12);
  const auto project = [&](const Vec3& point) {
    return *photograph.camera.project(photograph.cam_from_world * point);
  };
  EXPECT_NEAR((project({0, 0, 0}) - Vec2(32, 24)).norm(), 0, 1e-9);
  // p = (0.2, 0.1), |p|^2 = 0.05: f r(p) p from the centre, y up.
  const double r = 1 + 0.1 * 0.05 + 0.01 * 0.05 * 0.05;
  EXPECT_NEAR((project({1, 0.5, 0}) - Vec2(32 + 20 * r, 24 - 10 * r)).norm(), 0, 1e-9);
}

TEST(bundler, unregistered_cameras_are_left_out) {
  const TemporaryFolder folder;
  write_picture(folder, "sub/b c.png");
  const CameraFile file =
      read(folder, kTitle + "3 0\n" + kNone + kCamera + kNone, "a.png\nsub/b c.png 0 532.5\nd.png 0 1\n");
  ASSERT_EQ(file.photographs.size(), 1u);
  EXPECT_EQ(file.photographs[0].name, "sub/b c.png");
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_TRUE(holds(file.notes[0], "2 of 3 cameras were not registered"));
}

TEST(bundler, without_pictures_the_size_is_not_known) {
  const TemporaryFolder folder;
  const CameraFile file = read(folder, kTitle + "1 0\n" + kCamera, "a.png\n", false);
  EXPECT_EQ(file.photographs[0].camera.width, 0);
}

TEST(bundler, lists_stand_where_programs_put_them) {
  for (const char* list : {"a.list.txt", "a.bundle.out.list.txt", "list.txt", "../list.txt"}) {
    SCOPED_TRACE(list);
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "bundle");
    folder.write(std::filesystem::path("bundle") / list, "a.png\n");
    const auto bundle = folder.write("bundle/a.bundle.out", kTitle + "1 0\n" + kCamera);
    EXPECT_EQ(read_bundler(bundle, {}).photographs.at(0).name, "a.png");
    EXPECT_EQ(find_cameras(bundle)->format, CameraFormat::bundler);
  }
}

TEST(bundler, errors_name_file_and_line) {
  struct Case {
    std::string bundle, list, place, part;
  };
  const std::string one = kTitle + "1 1\n";
  const std::vector<Case> cases = {
      {"# Bundle file v0.4\n1 0\n" + kCamera, "a\n", "bundle.out:1", "expected \"# Bundle file v0.3\""},
      {kTitle + "1 x\n", "a\n", "bundle.out:2", "the count of points: expected a whole number"},
      {kTitle + "2 0\n" + kCamera, "a\n", "bundle.out:2", "found 2"},
      {kTitle + "1 -1\n" + kCamera, "a\n", "bundle.out:2", "-1 points"},
      {kTitle + "99999999999 0\n", "a\n", "bundle.out:2", "found 99999999999"},
      {kTitle + "1 0\n" + kCamera + kCamera, "a\n", "bundle.out:8", "expected nothing after the last point"},
      {one + kCamera, "a\n", "bundle.out:7", "the position of point 0, found the end of the file"},
      {one + kCamera + "1 2 3\n1 2 3\n2 0 17 1.5 -2.5 1 4 0\n", "a\n", "bundle.out:10",
       "the views of point 0, found the end of the line"},
      {kTitle + "1 0\n100 0\n", "a\n", "bundle.out:3", "f k1 k2 of camera 0"},
      {kTitle + "1 0\n-100 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -5\n", "a\n", "bundle.out:3", "focal length"},
      {kTitle + "1 0\n100 0 nan\n", "a\n", "bundle.out:3", "finite"},
      {kTitle + "1 0\n100 0 0\n1 0 0\n0 1 0\n0 0 1.1\n0 0 -5\n", "a\n", "bundle.out:3",
       "expected a rotation"},
      {kTitle + "1 0\n100 0 0\n1 0 0\n0 1 0\n0 0 -1\n0 0 -5\n", "a\n", "bundle.out:3",
       "found a mirrored one"},
      {kTitle + "1 0\n" + kNone, "a\n", "bundle.out", "at least one registered camera"},
      {kTitle + "2 0\n" + kCamera + kCamera, "a\na\n", "bundle.out", "photograph a occurs twice"},
  };
  for (const auto& [bundle, list, place, part] : cases) {
    SCOPED_TRACE(bundle);
    const TemporaryFolder folder;
    const std::string message =
        error_of(ErrorKind::input, [&, bundle = bundle, list = list] { read(folder, bundle, list, false); });
    EXPECT_TRUE(holds(message, (folder.path() / place).string() + ": "));
    EXPECT_TRUE(holds(message, part));
  }
}

TEST(bundler, no_list_and_no_picture) {
  const TemporaryFolder folder;
  const auto bundle = folder.write("bundle.out", kTitle + "1 0\n" + kCamera);
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_bundler(bundle, {}); }),
                    "bundle.out: expected the photographs' names in"));
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { read(folder, kTitle + "1 0\n" + kCamera, "missing.png\n"); }),
            "missing.png: no such file"));
}

}  // namespace
}  // namespace hybrid::io::bundler_test
