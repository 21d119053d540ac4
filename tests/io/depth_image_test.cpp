#include "io/depth_image.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/error.hpp"
#include "geometry/image.hpp"
#include "io/files.hpp"
#include "io/picture.hpp"
#include "io/scan_frame.hpp"
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
  const Vec3 in_camera = file_from_scanner(ScanAxes::camera) * p;
  EXPECT_NEAR(in_camera.x() / in_camera.z() * 525 + 319.5, 128, 1e-4);
  EXPECT_NEAR(in_camera.y() / in_camera.z() * 525 + 239.5, 240, 1e-4);
  const RangeImage image = stages::arrange_grid(scan);
  EXPECT_EQ(image.rows, 480);
  EXPECT_EQ(image.cols, 640);
}

TEST(DepthImage, intrinsics_of_another_size_are_noted) {
  const fs::path file = redwood() / "depth/00045.png";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  EXPECT_TRUE(read_depth_image(file, kCamera).notes.empty());
  for (const DepthCamera& odd :
       {DepthCamera{262.5, 262.5, 159.75, 119.75, 0.001}, DepthCamera{319.5, 239.5, 525, 525, 0.001}}) {
    const auto notes = read_depth_image(file, odd).notes;
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("near the middle of its 640 x 480 pixels"), std::string::npos) << notes[0];
  }
}

TEST(DepthImage, saturated_pixels_are_no_returns) {
  // Two pixels, 1 and 65535: a grey PNG of 16 bits.
  const testing::TemporaryFolder folder;
  const unsigned char bytes[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                                 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01,
                                 0x10, 0x00, 0x00, 0x00, 0x00, 0x81, 0xd9, 0xfc, 0x15, 0x00, 0x00, 0x00,
                                 0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x60, 0xfc, 0xff,
                                 0x1f, 0x00, 0x03, 0x05, 0x02, 0x00, 0x61, 0x5d, 0xaf, 0x9f, 0x00, 0x00,
                                 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const auto two = folder.write("two.png", std::string(bytes, bytes + sizeof bytes));
  const Scan scan = read_depth_image(two, {1, 1, 0.5, 0, 0.001});
  EXPECT_NEAR(scan.point(0).x(), 0.001, 1e-9);
  EXPECT_TRUE(std::isnan(scan.points[1][0]));
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_NE(scan.notes[0].find("1 of 2 pixels are 65535"), std::string::npos) << scan.notes[0];
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
