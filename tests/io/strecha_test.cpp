#include "io/cameras/strecha.hpp"

#include <gtest/gtest.h>

#include "io/cameras/read_cameras.hpp"
#include "io/files.hpp"

namespace hybrid::io {
namespace {
using testing::error_of;
using testing::holds;
using testing::real_data;
using testing::TemporaryFolder;

// A camera at (1, 2, 3) that looks along world +x with world z up: columns of R are its axes in the world.
const std::string kLooksAlongX =
    "100 0 31.5\n0 110 23.5\n0 0 1\n0 0 0\n0 0 1\n-1 0 0\n0 -1 0\n1 2 3\n64 48\n";

Photograph read_one(const std::string& text) {
  const TemporaryFolder folder;
  folder.write("a.jpg.camera", text);
  return read_strecha(folder.path()).photographs.at(0);
}

TEST(strecha, axes_position_and_pixel_centres) {
  const Photograph photograph = read_one(kLooksAlongX);
  EXPECT_EQ(photograph.name, "a.jpg");
  EXPECT_NEAR((photograph.centre() - Vec3(1, 2, 3)).norm(), 0, 1e-12);
  EXPECT_EQ(photograph.camera.width, 64);
  EXPECT_EQ(photograph.camera.height, 48);
  const auto project = [&](const Vec3& point) {
    return *photograph.camera.project(photograph.cam_from_world * point);
  };
  EXPECT_NEAR((project({11, 2, 3}) - Vec2(32, 24)).norm(), 0, 1e-9);  // K counts from a pixel's centre
  EXPECT_NEAR((project({11, 1, 3}) - Vec2(42, 24)).norm(), 0, 1e-9);  // world -y is right
  EXPECT_NEAR((project({11, 2, 4}) - Vec2(32, 13)).norm(), 0, 1e-9);  // up is up
}

TEST(strecha, files_sorted_and_others_ignored) {
  const TemporaryFolder folder;
  folder.write("b.png.camera", kLooksAlongX);
  folder.write("a b.png.camera", kLooksAlongX);
  folder.write("K.txt", "1 0 0");
  const CameraFile file = read_strecha(folder.path());
  ASSERT_EQ(file.photographs.size(), 2u);
  EXPECT_EQ(file.photographs[0].name, "a b.png");
  EXPECT_EQ(file.photographs[1].name, "b.png");
  EXPECT_EQ(file.cameras[0].model, "PINHOLE");
  ASSERT_TRUE(find_cameras(folder.path()));
  EXPECT_EQ(find_cameras(folder.path())->format, CameraFormat::strecha);
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kLooksAlongX;
  return text.replace(text.find(from), from.size(), to);
}

TEST(strecha, errors_name_file_and_line) {
  struct Case {
    std::string text;
    int line;
    std::string part;
  };
  const std::vector<Case> cases = {
      {with("100 0 31.5", "100 0"), 1, "expected row 1 of K, found the end of the line"},
      {with("100 0 31.5", "100 0 31.5 7"), 1, "and no more, found \"7\""},
      {with("100 0 31.5", "100 x 31.5"), 1, "expected a finite number, found \"x\""},
      {with("100 0 31.5", "nan 0 31.5"), 1, "finite"},
      {with("100 0 31.5", "100 5 31.5"), 3, "skew is not supported"},
      {with("0 0 1\n0 0 0", "0 0 2\n0 0 0"), 3, "K: expected fx 0 cx"},
      {with("100 0 31.5", "-100 0 31.5"), 3, "focal length"},
      {with("0 0 0\n0 0 1\n-1", "0.1 0 0\n0 0 1\n-1"), 4, "undistort the photographs"},
      {with("-1 0 0", "-1.01 0 0"), 7, "expected a rotation, found a matrix with R R^T off"},
      {with("-1 0 0", "1 0 0"), 7, "expected a rotation, found a mirrored one"},
      {with("1 2 3", "1 inf 3"), 8, "the camera's position C"},
      {with("64 48", "64.5 48"), 9, "width: expected a whole number"},
      {with("64 48", "0 48"), 9, "width: expected 1 to"},
      {with("64 48", "64 99999999999"), 9, "height: expected 1 to"},
      {with("64 48\n", "64 48\n1\n"), 10, "expected nothing after the image's size"},
      {"", 1, "expected row 1 of K, found the end of the file"},
  };
  const TemporaryFolder folder;
  for (const auto& [text, line, part] : cases) {
    SCOPED_TRACE(text);
    const auto file = folder.write("a.jpg.camera", text);
    const std::string message = error_of(ErrorKind::input, [&] { read_strecha(folder.path()); });
    EXPECT_TRUE(holds(message, file.string() + ":" + std::to_string(line) + ": "));
    EXPECT_TRUE(holds(message, part));
  }
}

// Four decimals of a rotation are a rotation, made exact.
TEST(strecha, rounded_rotations_are_made_exact) {
  const Photograph photograph =
      read_one(with("0 0 1\n-1 0 0\n0 -1 0", "0.0998 0 0.995\n-0.995 0 0.0998\n0 -1 0"));
  const Mat3 rotation = photograph.cam_from_world.rotation.toRotationMatrix();
  EXPECT_NEAR((rotation * rotation.transpose() - Mat3::Identity()).norm(), 0, 1e-14);
}

TEST(strecha, folders_without_cameras) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    return error_of(ErrorKind::input, [&] { read_strecha(path); });
  };
  EXPECT_TRUE(holds(message(folder.path()), "expected files NAME.camera"));
  EXPECT_TRUE(holds(message(folder.path() / "nowhere"), "no such folder"));
  EXPECT_TRUE(holds(message(folder.write("file", "")), "found a file"));
}

// Corners of the facade's reliefs, found in all eight photographs of Herz-Jesus by a feature matcher (the
// first pixel's centre at 0.5, 0.5), one row per corner.
constexpr double kHerzCorners[][8][2] = {
    {{1787.91, 414.21},
     {1638.29, 143.63},
     {1378.69, 277.26},
     {1217.62, 300.16},
     {863.33, 521.35},
     {524.15, 725.37},
     {260.68, 696.47},
     {85.09, 786.33}},
    {{1936.44, 726.49},
     {1850.78, 545.45},
     {1609.51, 616.69},
     {1449.41, 608.12},
     {1103.6, 820.58},
     {744.04, 988.6},
     {461.79, 936.9},
     {267.22, 1007.16}},
    {{1993.92, 1647.96},
     {1930.18, 1709.86},
     {1678.39, 1662.64},
     {1506.58, 1577.36},
     {1124.92, 1816.8},
     {725.75, 1911.43},
     {420.15, 1781.83},
     {207.95, 1821.4}},
    {{2014.34, 531.56},
     {1959.62, 303.9},
     {1734.47, 391.02},
     {1579.22, 390.54},
     {1254.27, 601.77},
     {896.64, 784.83},
     {611.48, 746.07},
     {411.72, 817.31}},
    {{2086.2, 1320.6},
     {2061.71, 1292.04},
     {1846.17, 1288.48},
     {1687.31, 1232.27},
     {1349.01, 1456.53},
     {965.12, 1574.33},
     {657.62, 1476.51},
     {442.68, 1523.31}},
};

// The point nearest to all rays through a corner's pixels.
Vec3 intersect(const std::vector<Photograph>& photographs, const double (&pixels)[8][2]) {
  Mat3 sum = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 ray = photographs[i].cam_from_world.rotation.conjugate() *
                     photographs[i].camera.ray({pixels[i][0], pixels[i][1]});
    const Mat3 across = Mat3::Identity() - ray * ray.transpose();
    sum += across;
    right += across * photographs[i].centre();
  }
  return sum.ldlt().solve(right);
}

TEST(strecha, real_rays_of_herz_jesus_meet) {
  const auto folder = real_data("photos/herz-jesus-p8/gt_dense_cameras");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const auto photographs = read_strecha(folder).photographs;
  ASSERT_EQ(photographs.size(), 8u);
  EXPECT_EQ(photographs[7].name, "0007.jpg");
  EXPECT_NEAR((photographs[0].centre() - Vec3(-6.71999, -14.2551, 0.279539)).norm(), 0, 1e-9);
  EXPECT_EQ(photographs[0].camera.cx, 1520.69 + 0.5);
  EXPECT_EQ(photographs[0].camera.fy, 2764.16);
  for (const auto& pixels : kHerzCorners) {
    const Vec3 corner = intersect(photographs, pixels);
    SCOPED_TRACE(corner.transpose());
    for (std::size_t i = 0; i < 8; ++i) {
      const auto pixel = photographs[i].camera.project(photographs[i].cam_from_world * corner);
      ASSERT_TRUE(pixel);
      // The survey's cameras are good to about a pixel; a transposed R or a flipped axis is off by hundreds.
      EXPECT_LT((*pixel - Vec2(pixels[i][0], pixels[i][1])).norm(), 2) << i;
    }
  }
}

}  // namespace
}  // namespace hybrid::io
