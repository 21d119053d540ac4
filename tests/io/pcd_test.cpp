#include "io/pcd/pcd.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

TEST(Pcd, FieldsInAnyOrderAndTypeWithCounts) {
  const ScanFolder folder;
  std::string data;
  for (int i = 0; i < 3; ++i) {
    data += raw(static_cast<std::int16_t>(-7 * i));                             // z
    data += std::string(12, 'n');                                               // normal, 3 floats
    data += raw(1.25 * i);                                                      // y, double
    data += raw(static_cast<std::uint16_t>(100 + i));                           // intensity
    data += "??";                                                               // padding
    data += raw(std::bit_cast<float>(0xff804000u + static_cast<unsigned>(i)));  // rgba as the bits of a NaN
    data += raw(static_cast<std::int64_t>(3 * i));                              // x
  }
  const auto file =
      folder.write("mixed.pcd",
                   "VERSION .7\nFIELDS Z normal y Intensity _ rgba x\nSIZE 2 4 8 2 1 4 8\nTYPE I F F U U F "
                   "I\nCOUNT 1 3 1 1 2 1 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA binary\n" +
                       data);
  const Scan scan = io::read_pcd(file);
  ASSERT_EQ(scan.points.size(), 3u);
  EXPECT_EQ(scan.points[2], (std::array<float, 3>{6, 2.5f, -14}));
  EXPECT_EQ(scan.intensity[1], 101);
  EXPECT_EQ(scan.rgb[2],
            (std::array<std::uint8_t, 3>{0x80, 0x40, 2}));  // bits survive although they are a NaN
  EXPECT_FALSE(scan.organised());
  EXPECT_FALSE(scan.world_from_scan);
  EXPECT_EQ(scan.notes, std::vector<std::string>{"fields not used: normal"});
}

TEST(Pcd, OrganisedKeepsTheFilesOrder) {
  const ScanFolder folder;
  // 2 rows of 3, row by row; x = column, y = row.
  const auto file =
      folder.write("grid.pcd",
                   "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 3\nHEIGHT 2\nDATA ascii\n"
                   "0 0 1 10\n1 0 1 11\n2 0 1 12\n0 1 1 20\n1 1 1 21\n2 1 1 22\n");
  const Scan scan = io::read_pcd(file);
  ASSERT_TRUE(scan.organised());
  EXPECT_EQ(scan.grid_rows, 2);
  EXPECT_EQ(scan.grid_cols, 3);
  EXPECT_EQ(scan.intensity, (std::vector<float>{10, 11, 12, 20, 21, 22}));
  for (int col = 0; col < 3; ++col)
    for (int row = 0; row < 2; ++row)
      EXPECT_EQ(scan.points[scan.grid_index(row, col)],
                (std::array<float, 3>{static_cast<float>(col), static_cast<float>(row), 1}));
}

TEST(Pcd, ViewpointIsThePose) {
  const ScanFolder folder;
  const double half = std::sqrt(0.5);
  const auto file = folder.write(
      "pose.pcd",
      fmt::format(
          "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 10 20 30 {} 0 0 {}\nDATA "
          "ascii\n1 0 0\n",
          half, half));
  const Scan scan = io::read_pcd(file);
  ASSERT_TRUE(scan.world_from_scan);
  EXPECT_LT((*scan.world_from_scan * Vec3(1, 0, 0) - Vec3(10, 21, 30)).norm(),
            1e-12);  // a quarter turn about Z
  EXPECT_EQ(scan.points[0], (std::array<float, 3>{1, 0, 0}));
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_NE(scan.notes[0].find("VIEWPOINT"), std::string::npos);
}

TEST(Pcd, LargeCoordinatesKeepTheirPrecision) {
  const ScanFolder folder;
  const double x = 530123.4567, y = 180987.6543, z = 21.0009;
  const auto file = folder.write(
      "world.pcd",
      fmt::format(
          "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 3\nHEIGHT 1\nDATA ascii\n{} {} {}\n{} {} {}\n0 0 "
          "0\n",
          x, y, z, x + 12.3456, y - 7.8901, z));
  const Scan scan = io::read_pcd(file);
  EXPECT_LT((scan.origin - Vec3(530123, 180988, 21)).norm(), 1e-3);
  const auto world = [&](std::size_t i) {
    return Vec3(scan.origin + Vec3(scan.points[i][0], scan.points[i][1], scan.points[i][2]));
  };
  EXPECT_LT((world(0) - Vec3(x, y, z)).norm(), 1e-6);
  EXPECT_LT((world(1) - Vec3(x + 12.3456, y - 7.8901, z)).norm(), 1e-6);
  EXPECT_TRUE(std::isnan(scan.points[2][0]));  // a no-return stays one, whatever the origin
}

TEST(Pcd, PointOnTheRoundedOriginIsStillAReturn) {
  const ScanFolder folder;
  const Scan scan = io::read_pcd(folder.write(
      "whole.pcd",
      "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n530000 180000 20\n"));
  EXPECT_NE(scan.points[0], (std::array<float, 3>{0, 0, 0}));
}

TEST(Pcd, SixteenBitColoursMayHoldBytes) {
  const ScanFolder folder;
  const std::string header =
      "FIELDS x y z Red Green Blue\nSIZE 4 4 4 2 2 2\nTYPE F F F U U U\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 "
      "3 ";
  const auto colour = [&](const std::string& values) {
    return io::read_pcd(folder.write("c.pcd", header + values + "\n")).rgb.at(0);
  };
  EXPECT_EQ(colour("255 128 1"), (std::array<std::uint8_t, 3>{255, 128, 1}));
  EXPECT_EQ(colour("65535 32896 257"), (std::array<std::uint8_t, 3>{255, 128, 1}));
}

TEST(Pcd, NoPointsIsAScanWithoutPoints) {
  const ScanFolder folder;
  const Scan scan = io::read_pcd(folder.write(
      "none.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA binary\n"));
  EXPECT_TRUE(scan.points.empty());
  EXPECT_EQ(scan.notes, std::vector<std::string>{"no points"});
}

TEST(Pcd, CompressedDamageIsFound) {
  const ScanFolder folder;
  const std::string intact = sample_file("pcd", "binary_compressed");
  const std::size_t data = intact.find("binary_compressed\n") + 18;
  const auto expect_damage = [&](std::size_t at, char byte, const char* part) {
    std::string bytes = intact;
    bytes[data + at] = byte;
    const auto file = folder.write("damaged.pcd", bytes);
    expect_input_error([&] { io::read_pcd(file); }, {file.string(), "byte", part});
  };
  expect_damage(0, '\x7f', "compressed bytes");   // compressed size
  expect_damage(4, '\x7f', "uncompressed size");  // uncompressed size
  expect_damage(8, '\xe0', "match before the start");
  expect_damage(8, '\x00', "match");  // the run is shorter, its rest is taken for control bytes
}

}  // namespace
}  // namespace hybrid::testing
