#include "io/scan_info.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "io/exr/range_exr.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

TEST(ScanInfo, OfAScan) {
  Scan scan;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scan.name = "west";
  scan.points = {{3, 4, 0}, {nan, nan, nan}, {0, 0, 0}, {-1, 0, 0}, {0, 0, 12}, {0, -2, 0}};
  scan.grid_rows = 2;
  scan.grid_cols = 3;
  scan.intensity.resize(6);
  scan.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), {1, 2, 3}};
  scan.notes = {"odd"};
  const io::ScanInfo info = io::describe(io::ScanInMemory(scan), "PTX");
  EXPECT_EQ(info.format, "PTX");
  EXPECT_EQ(info.name, "west");
  EXPECT_EQ(info.points, 6u);
  EXPECT_EQ(info.returns, 4u);
  EXPECT_EQ(info.grid_rows, 2);
  EXPECT_EQ(info.grid_cols, 3);
  EXPECT_EQ(info.min_m, Vec3(-1, -2, 0));
  EXPECT_EQ(info.max_m, Vec3(3, 4, 12));
  EXPECT_EQ(info.min_range_m, 1);
  EXPECT_EQ(info.max_range_m, 12);
  EXPECT_TRUE(info.has_intensity);
  EXPECT_FALSE(info.has_colour);
  EXPECT_EQ(info.world_from_scan->translation, Vec3(1, 2, 3));
  EXPECT_EQ(info.notes, scan.notes);

  scan.origin = {1000, 0, 0};
  EXPECT_EQ(io::describe(io::ScanInMemory(scan), "PTX").returns,
            5u);  // only NaN is a no-return when the origin is elsewhere
  EXPECT_EQ(io::describe(io::ScanInMemory(scan), "PTX").max_m.x(), 1003);
}

TEST(ScanInfo, NoReturnAtAll) {
  const io::ScanInfo info = io::describe(io::ScanInMemory(Scan{}), "PLY");
  EXPECT_EQ(info.points, 0u);
  EXPECT_EQ(info.returns, 0u);
  EXPECT_EQ(info.max_m, Vec3(0, 0, 0));
  EXPECT_EQ(info.max_range_m, 0);
}

TEST(ScanInfo, OfFiles) {
  const ScanFolder folder;
  const auto ptx = io::read_scan_info(folder.write("a.Ptx", sample_file("ptx", "") + sample_file("ptx", "")));
  ASSERT_EQ(ptx.size(), 2u);
  EXPECT_EQ(ptx[1].format, "PTX");
  EXPECT_EQ(ptx[1].name, "a-1");
  EXPECT_TRUE(ptx[1].has_colour);
  ASSERT_TRUE(ptx[1].world_from_scan);

  RangeImage image = make_range_image(2, 3);
  image.mask[4] = kMeasured;
  image.range_m[4] = 5;
  image.x[4] = 3, image.y[4] = 0, image.z[4] = 4;
  io::write_range_exr(folder.path("range.exr"), image, {{"source", "a.ptx"}});
  const auto exr = io::read_scan_info(folder.path("range.exr"));
  ASSERT_EQ(exr.size(), 1u);
  EXPECT_EQ(exr[0].points, 6u);
  EXPECT_EQ(exr[0].returns, 1u);
  EXPECT_EQ(exr[0].grid_cols, 3);
  EXPECT_EQ(exr[0].max_range_m, 5);
  EXPECT_EQ(exr[0].notes, std::vector<std::string>{"source: a.ptx"});

  expect_input_error([&] { io::read_scan_info(folder.write("noextension", "x")); }, {"no extension"});
}

}  // namespace
}  // namespace hybrid::testing
