#include "io/depth_image.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "core/error.hpp"
#include "geometry/image.hpp"
#include "io/files.hpp"
#include "io/picture.hpp"
#include "places.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::io::depth_image_test {
namespace {
namespace fs = std::filesystem;

fs::path redwood() {
  const char* data = std::getenv("HYBRID_DATA");
  return (data ? fs::path(data) : fs::path(HYBRID_PROJECT_DIR) / ".." / "shared" / "data") /
         "photos/redwood-livingroom";
}

constexpr DepthCamera kCamera{525, 525, 319.5, 239.5, 0.001};

}  // namespace

TEST(DepthImage, a_real_frame_has_a_node_per_pixel_where_the_camera_saw_it) {
  const fs::path file = redwood() / "depth/00045.png";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Scan scan = read_depth_image(file, kCamera);
  EXPECT_EQ(scan.grid_rows, 480);
  EXPECT_EQ(scan.grid_cols, 640);
  // Row 240, column 128: 1.982 m along the optical axis (checked with another decoder).
  const Vec3 p = scan.point(static_cast<std::size_t>(240 * 640 + 128));
  EXPECT_NEAR(p.x(), 1.982, 1e-6);
  EXPECT_NEAR(p.y(), 1.982 * (319.5 - 128) / 525, 1e-6);
  EXPECT_NEAR(p.z(), 1.982 * (239.5 - 240) / 525, 1e-6);
  const Vec3 in_camera = camera_from_depth_scan() * p;
  EXPECT_NEAR(in_camera.x() / in_camera.z() * 525 + 319.5, 128, 1e-4);
  EXPECT_NEAR(in_camera.y() / in_camera.z() * 525 + 239.5, 240, 1e-4);
  const RangeImage image = stages::arrange_grid(scan);
  EXPECT_EQ(image.rows, 480);
  EXPECT_EQ(image.cols, 640);
}

TEST(DepthImage, colours_are_no_depths) {
  const testing::TemporaryFolder folder;
  Image8 picture(4, 3, 3);
  write_png(folder.path() / "colour.png", picture);
  try {
    read_depth_image(folder.path() / "colour.png", kCamera);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("3 channels with 8 bits"), std::string::npos) << error.what();
  }
  EXPECT_THROW(read_depth_image(folder.path() / "none.png", kCamera), Error);
  EXPECT_THROW(read_depth_image(folder.write("text.png", "no picture"), kCamera), Error);
}

}  // namespace hybrid::io::depth_image_test
