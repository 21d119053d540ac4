#include "geometry/st_map.hpp"

#include <gtest/gtest.h>

namespace hybrid::testing {
namespace {

Camera lens(double k1, double k2, Lens kind = Lens::brown) {
  Camera camera;
  camera.width = 120;
  camera.height = 80;
  camera.fx = 100;
  camera.fy = 101;
  camera.cx = 61;
  camera.cy = 39.5;
  camera.k1 = k1;
  camera.k2 = k2;
  camera.lens = kind;
  if (kind == Lens::brown) camera.p1 = 0.001, camera.p2 = -0.002;
  return camera;
}

const Camera kLenses[] = {lens(-0.2, 0.03), lens(0.15, 0), lens(0.02, -0.003, Lens::fisheye)};

}  // namespace

TEST(StMap, the_pinhole_picture_holds_the_whole_photograph) {
  for (const Camera& camera : kLenses) {
    const Camera pinhole = pinhole_of(camera);
    EXPECT_FALSE(is_distorted(pinhole));
    EXPECT_TRUE(is_distorted(camera));
    const ImageF map = st_map(camera, pinhole);  // every pixel of the photograph is somewhere in it
    for (const float value : map.pixels) {
      EXPECT_GE(value, 0);
      EXPECT_LE(value, 1);
    }
    EXPECT_EQ(pinhole.cx - camera.cx, std::round(pinhole.cx - camera.cx));
  }
}

// By the formula alone (OpenCV's): which pixel of the photograph shows what the pinhole's pixel shows.
TEST(StMap, follows_the_distortion_formula) {
  const Camera camera = kLenses[0], pinhole = pinhole_of(camera);
  const ImageF map = st_map(pinhole, camera);
  int inside = 0;
  for (int row = 0; row < pinhole.height; ++row)
    for (int col = 0; col < pinhole.width; ++col) {
      const double x = (col + 0.5 - pinhole.cx) / pinhole.fx, y = (row + 0.5 - pinhole.cy) / pinhole.fy;
      const double s = x * x + y * y, q = 1 - 0.2 * s + 0.03 * s * s;
      const double column = 100 * (x * q + 2 * 0.001 * x * y - 0.002 * (s + 2 * x * x)) + 61;
      const double line = 101 * (y * q - 2 * 0.002 * x * y + 0.001 * (s + 2 * y * y)) + 39.5;
      const float* st = map.at(col, row);
      if (column < 0 || line < 0 || column >= 120 || line >= 80) {
        EXPECT_EQ(st[0], -1);
        EXPECT_EQ(st[1], -1);
        continue;
      }
      ++inside;
      EXPECT_NEAR(st[0], column / 120, 1e-6);
      EXPECT_NEAR(st[1], 1 - line / 80, 1e-6);
    }
  EXPECT_GT(inside, 9000);
}

TEST(StMap, there_and_back_is_where_one_was) {
  for (const Camera& camera : kLenses) {
    const Camera pinhole = pinhole_of(camera);
    const ImageF back = st_map(camera, pinhole);
    for (int row = 0; row < camera.height; ++row)
      for (int col = 0; col < camera.width; ++col) {
        const double column = back.at(col, row)[0] * pinhole.width;
        const double line = (1 - back.at(col, row)[1]) * pinhole.height;
        const auto at = camera.project(pinhole.ray({column, line}));
        ASSERT_TRUE(at.has_value());
        EXPECT_NEAR(at->x(), col + 0.5, 2e-4);  // floats in between
        EXPECT_NEAR(at->y(), row + 0.5, 2e-4);
      }
  }
}

TEST(StMap, panoramas_and_pinholes_are_not_distorted) {
  Camera camera;
  EXPECT_FALSE(is_distorted(camera));
  camera.lens = Lens::spherical;
  camera.k1 = 1;  // means nothing there
  EXPECT_FALSE(is_distorted(camera));
}

}  // namespace hybrid::testing
