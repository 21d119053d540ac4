#include "io/ply/ply.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

std::vector<io::PlyPoint> some_points(std::size_t count, const std::array<double, 3>& around) {
  std::vector<io::PlyPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i);
    points[i] = {
        {around[0] + 7 * std::sin(t) + 8, around[1] + 5 * std::cos(1.7 * t), around[2] + 0.001 * t},
        static_cast<float>(i % 97) / 96,
        {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(3 * i), static_cast<std::uint8_t>(7 * i)}};
  }
  return points;
}

TEST(Ply, RoundTripOfEveryContent) {
  const ScanFolder folder;
  // More than one block of the writer and of the reader's choice of origin.
  const auto points = some_points(100003, {0, 0, 0});
  for (int bits = 0; bits < 8; ++bits) {
    const io::PlyContent content{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
    const auto file = folder.path("a/b/detail.ply");
    io::write_ply(file, points, content);
    const Scan scan = io::read_ply(file);
    ASSERT_EQ(scan.points.size(), points.size());
    ASSERT_EQ(scan.intensity.size(), content.intensity ? points.size() : 0);
    ASSERT_EQ(scan.rgb.size(), content.colour ? points.size() : 0);
    EXPECT_TRUE(scan.notes.empty());
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_EQ(scan.points[i][k], static_cast<float>(points[i].position[k])) << i;
      if (content.intensity) {
        ASSERT_EQ(scan.intensity[i], points[i].intensity);
      }
      if (content.colour) {
        ASSERT_EQ(scan.rgb[i], points[i].rgb);
      }
    }
    const std::string first = bytes_of(file);
    io::write_ply(file, points, content);
    EXPECT_EQ(bytes_of(file), first);
  }
}

TEST(Ply, RoundTripOfGeoreferencedDoubles) {
  const ScanFolder folder;
  const auto points = some_points(70001, {530000.25, 180000.5, 47});
  const auto file = folder.path("world.ply");
  io::write_ply(file, points, {.double_precision = true});
  const Scan scan = io::read_ply(file);
  ASSERT_EQ(scan.points.size(), points.size());
  EXPECT_GT(scan.origin.norm(), 500000);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)  // float within 100 m of the origin: 4 micrometres
      ASSERT_NEAR(scan.origin[static_cast<int>(k)] + static_cast<double>(scan.points[i][k]),
                  points[i].position[k], 4e-6);
}

TEST(Ply, EmptyAndNoReturns) {
  const ScanFolder folder;
  const auto file = folder.path("few.ply");
  io::write_ply(file, {}, {true, true, true});
  EXPECT_TRUE(io::read_ply(file).points.empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  io::write_ply(file, {{{nan, 1, 2}}, {{1, 2, 3}}}, {});
  const Scan scan = io::read_ply(file);
  EXPECT_TRUE(std::isnan(scan.points[0][0]));
  EXPECT_EQ(scan.points[1], (std::array<float, 3>{1, 2, 3}));
  EXPECT_NE(scan.notes.at(0).find("1 of 2 points are not finite"), std::string::npos);
}

// Elements and lists before, in and after the vertices, properties in an odd order.
std::string odd_file(const std::string& format) {
  const bool ascii = format == "ascii", big = format == "binary_big_endian";
  std::string data;
  if (ascii) {
    data = "0 0 255 7 8 9\n3 1 2 3 4\n\n\t 0 4\n";
    data += "-3 2 11 12 0.5 1e0 +2.5 200\n6 0 0.25 -1 -2.5 100\n";
    data += "3 0 1 2\n2 7 7\n";
  } else {
    for (int i : {0, 0, 255, 7, 8, 9}) data += raw(i, big);
    data += raw<std::uint16_t>(3, big);
    for (int i : {1, 2, 3, 4}) data += raw(i, big);
    data += raw<std::uint16_t>(0, big) + raw(4, big);
    data += raw<std::int16_t>(-3, big) + raw<std::uint8_t>(2) + raw(11, big) + raw(12, big) + raw(0.5f, big) +
            raw(1.0, big) + raw(2.5f, big) + raw(200.0f, big);
    data += raw<std::int16_t>(6, big) + raw<std::uint8_t>(0) + raw(0.25f, big) + raw(-1.0, big) +
            raw(-2.5f, big) + raw(100.0f, big);
    data += raw<std::uint8_t>(3) + raw(0, big) + raw(1, big) + raw(2, big);
    data += raw<std::uint8_t>(2) + raw(7, big) + raw(7, big);
  }
  return "ply\nformat " + format +
         " 1.0\ncomment end_header in a comment\nobj_info x\nelement camera 1\nproperty int a\nproperty int "
         "b\nproperty "
         "int c\nproperty int d\nproperty int e\nproperty int f\nelement odd 2\nproperty list ushort int "
         "l\nproperty "
         "int m\nelement vertex 2\nproperty short Z\nproperty list uchar int neighbours\nproperty float32 "
         "scalar_Intensity\nproperty float64 y\nproperty float x\nproperty float radius\nelement face "
         "2\nproperty list "
         "uchar int vertex_indices\nend_header\n" +
         data;
}

TEST(Ply, OtherElementsAndListsAreSkipped) {
  const ScanFolder folder;
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    const Scan scan = io::read_ply(folder.write("odd.ply", odd_file(format)));
    ASSERT_EQ(scan.points.size(), 2u);
    EXPECT_EQ(scan.points[0], (std::array<float, 3>{2.5f, 1, -3}));
    EXPECT_EQ(scan.points[1], (std::array<float, 3>{-2.5f, -1, 6}));
    EXPECT_EQ(scan.intensity, (std::vector<float>{0.5f, 0.25f}));
    EXPECT_EQ(scan.notes, (std::vector<std::string>{"properties not used: neighbours radius",
                                                    "elements not used: 1 camera, 2 odd, 2 face"}));
  }
}

TEST(Ply, EveryCutOfListsIsFound) {
  const ScanFolder folder;
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string bytes = odd_file(format);
    for (std::size_t size = bytes.find("end_header"); size < bytes.size(); ++size) {
      const auto file = folder.write("cut.ply", bytes.substr(0, size));
      expect_input_error([&] { io::read_ply(file); }, {file.string(), "expected", "found"});
    }
  }
}

TEST(Ply, NegativeListCount) {
  const ScanFolder folder;
  const auto file = folder.write(
      "negative.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list char int l\nproperty "
      "float x\nproperty float y\nproperty float z\nend_header\n\xff" +
          std::string(12, '\0'));
  expect_input_error([&] { io::read_ply(file); }, {file.string(), "byte", "count of list", "-1"});
}

TEST(Ply, RealColours) {
  const ScanFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty float "
      "red\nproperty float green\nproperty float blue\nend_header\n";
  EXPECT_EQ(io::read_ply(folder.write("c.ply", header + "1 2 3 0 0.5 1\n1 2 3 1 nan 2e-400\n")).rgb,
            (std::vector<std::array<std::uint8_t, 3>>{{0, 128, 255}, {255, 0, 0}}));
  EXPECT_EQ(io::read_ply(folder.write("c.ply", header + "1 2 3 0 0.5 1\n1 2 3 1 200 -3\n")).rgb,
            (std::vector<std::array<std::uint8_t, 3>>{{0, 1, 1}, {1, 200, 0}}));
}

// With lone CR line ends, the data may begin with a line feed that belongs to it.
TEST(Ply, BinaryAfterCarriageReturnHeader) {
  const ScanFolder folder;
  std::string header =
      "ply\rformat binary_big_endian 1.0\relement vertex 1\rproperty int x\rproperty int y\rproperty int "
      "z\rend_header\r";
  const std::string data = raw(0x0a000001, true) + raw(2, true) + raw(3, true);
  const Scan scan = io::read_ply(folder.write("cr.ply", header + data));
  EXPECT_EQ(static_cast<double>(scan.points[0][0]) + scan.origin.x(), 0x0a000001);
}

}  // namespace
}  // namespace hybrid::testing
