// Coordinates that float would round survive conversions: doubles as doubles, decimals as decimals, whole
// numbers as whole numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/e57_scans.hpp"
#include "io/files.hpp"
#include "io/las/las_records.hpp"
#include "io/read_scan.hpp"
#include "io/scan_writers.hpp"
#include "io/stream_scan.hpp"

namespace hybrid::testing {
namespace {

constexpr io::ReadOptions kExact{.exact = true};

Scan read_exact(const std::filesystem::path& file) {
  return io::read_scan(file, io::list_scans(file, kExact).at(0));
}

// What `hybrid convert` does.
io::WriteLosses convert(const std::filesystem::path& from, const std::filesystem::path& to) {
  auto scan = io::stream_scan(from, io::list_scans(from, kExact).at(0));
  const io::ScanWriter& writer = io::writer_for(to);
  const auto losses = io::losses_of(writer, *scan);
  writer.write(to, [&] { return std::move(scan); });
  return losses;
}

// The returns' coordinates.
std::vector<std::array<double, 3>> coordinates(const std::filesystem::path& file) {
  const Scan scan = read_exact(file);
  std::vector<std::array<double, 3>> found;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (std::isfinite(scan.points[i][0])) {
      const Vec3 point = scan.exact_point(i);
      found.push_back({point.x(), point.y(), point.z()});
    }
  return found;
}

// Doubles with all their bits, about so far away.
std::vector<std::array<double, 3>> doubles(double around) {
  std::mt19937_64 random(5);
  const auto real = [&] { return around + std::ldexp(static_cast<double>(random() >> 11), -49); };
  std::vector<std::array<double, 3>> points(500);
  for (auto& point : points) point = {real(), -real(), 0.01 * real()};
  return points;
}

std::string ply_of(const std::vector<std::array<double, 3>>& points) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n",
      points.size());
  for (const auto& point : points)
    for (const double value : point) bytes += little_endian(value);
  return bytes;
}

}  // namespace

TEST(ExactCoordinates, DoublesSurviveInEveryFormatThatHoldsThem) {
  const TemporaryFolder folder;
  for (const double around : {0.0, 5e5}) {
    const auto points = doubles(around);
    const auto ply = folder.write("in.ply", ply_of(points));
    ASSERT_EQ(coordinates(ply), points);
    for (const char* name : {"a.ptx", "a.pts", "a.pcd", "a.e57", "a.exr", "a.ply"}) {
      SCOPED_TRACE(name);
      const auto there = folder.path() / name, back = folder.path() / "back.ply";
      EXPECT_TRUE(convert(ply, there).changed.empty());
      EXPECT_EQ(coordinates(there), points);
      convert(there, back);
      EXPECT_EQ(coordinates(back), points);
    }
  }
}

TEST(ExactCoordinates, DecimalsOfATextAreTheSameDigitsAgain) {
  const TemporaryFolder folder;
  const std::string text =
      "3\n12.345678901 -0.1234567 3.300000001\n7.1 8.00000000012 9\n530000.123456 180000.654321 12.0001\n";
  const auto pts = folder.write("in.pts", text);
  for (const char* name : {"a.ptx", "a.ply", "a.pcd", "a.e57", "a.exr"}) {
    SCOPED_TRACE(name);
    const auto back = folder.path() / "back.pts";
    convert(pts, folder.path() / name);
    convert(folder.path() / name, back);
    std::string found = bytes_of(back);
    if (std::string(name) == "a.ptx")  // which has an intensity always
      for (std::size_t at; (at = found.find(" -2048\n")) != found.npos;) found.erase(at, 6);
    EXPECT_EQ(found, text);
  }
}

TEST(ExactCoordinates, FloatsStayFloats) {
  const TemporaryFolder folder;
  const auto pts = folder.write("in.pts", "2\n1.5 2.25 -3\n0.125 7 1\n");
  convert(pts, folder.path() / "a.e57");
  EXPECT_TRUE(read_exact(pts).exact.empty());
  const io::E57File made(folder.path() / "a.e57");
  for (const auto& field : made.contents().scans[0].points.fields)
    EXPECT_EQ(field.type, io::E57Type::single_real) << field.name;
  EXPECT_TRUE(io::read_scan(pts, 0).exact.empty());  // nobody asked
}

// Stored whole numbers of an E57 file, through LAS, are the same whole numbers.
TEST(ExactCoordinates, WholeNumbersOfE57SurviveInLas) {
  const TemporaryFolder folder;
  struct Case {
    double scale, offset;
    std::int64_t low, high;
    bool rounded;
  };
  for (const Case& c : {Case{1e-4, 0, -300'000, 400'000, false},
                        {1e-6, 12.5, -90'000'000, 10'000'000, false},
                        {0.00025, -7, -1000, 2'000'000, false},
                        {1e-5, 530'000, 0, 4'000'000'000, false},
                        {1e-4, 0, 5'300'000'000, 5'300'400'000, false},
                        {1e-9, 0, 0, 20'000'000'000, true}}) {
    SCOPED_TRACE(::testing::Message() << c.scale << ' ' << c.offset << ' ' << c.low << ' ' << c.high);
    io::E57Scan scan;
    for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
      scan.points.fields.push_back(scaled_field(axis, c.low, c.high, c.scale, c.offset));
    const E57Columns columns = random_columns(scan.points.fields, 400);
    const auto e57 = folder.path() / "in.e57", las = folder.path() / "a.las";
    write_e57(e57, scan, columns);
    const auto losses = convert(e57, las);
    ASSERT_EQ(losses.changed.size(), c.rounded ? 1u : 0u);
    if (c.rounded) {
      EXPECT_EQ(losses.changed[0], "coordinates rounded to steps of 1e-08 m, by up to 5e-09 m");
      continue;
    }
    const io::LasAsE57 read(las);
    const io::E57Table& table = read.table(0);
    ASSERT_EQ(table.count, 400u);
    const std::array<std::size_t, 3> fields{0, 1, 2};
    read.open(0)->read(fields, 0, 400, [&](const io::E57Records& records) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(table.fields[k].scale, c.scale);
        const double shift = std::round((table.fields[k].offset - c.offset) / c.scale);
        for (std::size_t i = 0; i < records.count; ++i)
          ASSERT_EQ(records.integers[k][i] + static_cast<std::int64_t>(shift),
                    columns.integers[k][records.first + i]);
      }
    });
    // And back, and as text with no more digits than the steps have.
    const auto ptx = folder.path() / "a.ptx";
    convert(las, ptx);
    const auto expected = coordinates(las), found = coordinates(ptx);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(found[i][k], expected[i][k], 1.1e-4 * c.scale);
    EXPECT_LT(bytes_of(ptx).size(), 400 * 3 * 18 + 200u);
  }
}

// Floats and decimals need no whole numbers: LAS takes the steps in which they survive.
TEST(ExactCoordinates, LasTakesTheStepsInWhichCoordinatesSurvive) {
  const TemporaryFolder folder;
  const auto las = folder.path() / "a.las";
  const auto scale_of = [&](const std::string& points) {
    EXPECT_TRUE(convert(folder.write("in.pts", points), las).changed.empty()) << points;
    return io::LasAsE57(las).table(0).fields[0].scale;
  };
  EXPECT_EQ(scale_of("2\n1.5 2.25 -3\n0.12345 7 1\n"), 1e-5);
  EXPECT_EQ(scale_of("2\n1.5 2.25 -3\n0.1234567 7 1\n"), 1e-7);
  EXPECT_EQ(scale_of("2\n530000.123456 180000.5 3\n530001 180001 3\n"), 1e-6);
  // Half a kilometre in steps of 1e-9 m is beyond 32 bits.
  const auto pts = folder.write("far.pts", "2\n-250.123456789 0 3\n250.123456789 0 3\n");
  EXPECT_EQ(convert(pts, las).changed,
            std::vector<std::string>{"coordinates rounded to steps of 1e-06 m, by up to 2.1e-07 m"});
}

}  // namespace hybrid::testing
