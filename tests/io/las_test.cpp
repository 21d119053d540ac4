#include "io/las/las.hpp"

#include <gtest/gtest.h>

#include "io/las/las_header.hpp"
#include "io/las_samples.hpp"
#include "io/read_scan.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::las_test {
namespace {

void expect_sample(const Scan& scan) {
  ASSERT_EQ(scan.points.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(scan.points[i][k], kSamplePoints[i][k]);
      EXPECT_EQ(scan.rgb[i][k], kSampleRgb[i][k]);
    }
    EXPECT_EQ(scan.intensity[i], 1000 * kSampleIntensity[i]);
  }
  EXPECT_EQ(scan.intensity_limits, (std::array<float, 2>{0, 65535}));
  EXPECT_TRUE(scan.notes.empty()) << scan.notes[0];
}

TEST(Las, VersionsWithTheirCoordinateSystems) {
  const ScanFolder folder;
  for (const int minor : {0, 1, 2, 3, 4}) {
    SCOPED_TRACE(minor);
    const auto file = folder.write("a.las", las_sample(minor));
    const auto entries = io::list_scans(file);
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].samples, 4u);
    EXPECT_EQ(entries[0].unit, "m");
    const Scan scan = io::read_scan(file, entries[0]);
    expect_sample(scan);
    EXPECT_EQ(scan.crs, minor == 4 ? kSampleWkt : "EPSG:27700");
    ASSERT_EQ(scan.crs_records.size(), 1u);
    EXPECT_EQ(scan.crs_records[0].id, minor == 4 ? 2112 : 34735);
  }
}

TEST(Las, CoordinatesInFeetAreNamed) {
  const ScanFolder folder;
  std::string file = las_sample(2);
  const auto key = [](std::uint16_t unit) {
    std::string bytes;
    for (const int word : {3076, 0, 1, int{unit}}) bytes += raw(static_cast<std::uint16_t>(word));
    return bytes;
  };
  const std::size_t at = file.find(key(9001));
  ASSERT_NE(at, std::string::npos);
  file.replace(at, 8, key(9003));
  const Scan scan = io::read_scan(folder.write("a.las", file), 0);
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_TRUE(holds(scan.notes[0], "counts in US survey ft: coordinates stay as they are"));
}

// The same four points in records of every format, with extra bytes at their ends.
TEST(Las, AllPointFormats) {
  const ScanFolder folder;
  const std::string sample = las_sample(4);
  const std::size_t data = sample.size() - 4 * 36;
  for (int format = 0; format < io::kLasPointFormats; ++format) {
    SCOPED_TRACE(format);
    const auto& layout = io::las_point_format(format);
    const std::size_t bytes = static_cast<std::size_t>(layout.bytes) + 3;
    std::string file = sample.substr(0, data);
    file[104] = static_cast<char>(format);
    file.replace(105, 2, raw(static_cast<std::uint16_t>(bytes)));
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string from = sample.substr(data + 36 * i, 36);
      std::string record = from.substr(0, 14) + (format < 6 ? '\x09' : '\x11');
      record.resize(bytes, '\0');
      if (layout.red > 0) record.replace(static_cast<std::size_t>(layout.red), 6, from.substr(30, 6));
      file += record;
    }
    Scan scan = io::read_scan(folder.write("a.las", file), 0);
    EXPECT_EQ(scan.rgb.empty(), layout.red == 0);
    if (scan.rgb.empty())
      for (const auto& rgb : kSampleRgb) scan.rgb.push_back({rgb[0], rgb[1], rgb[2]});
    expect_sample(scan);
  }
}

TEST(Las, LargeCoordinatesKeepTheirDigits) {
  const ScanFolder folder;
  std::string bytes = las_sample(2);
  for (int axis = 0; axis < 3; ++axis) bytes.replace(131 + 8 * axis, 8, raw(0.001));
  bytes.replace(155, 24, raw(637012.0) + raw(849028.0) + raw(431.0));
  const Scan scan = io::read_scan(folder.write("a.las", bytes), 0);
  EXPECT_FALSE(scan.origin.isZero());
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 expected(637012 + 0.001 * 8 * (kSamplePoints[i][0] + 1),
                        849028 + 0.001 * 8 * kSamplePoints[i][1], 431 + 0.001 * 8 * kSamplePoints[i][2]);
    EXPECT_LT((scan.point(i) - expected).norm(), 1e-8);
  }
}

TEST(Las, FieldsThatAreNotUsedAreNamed) {
  const ScanFolder folder;
  std::string bytes = las_sample(2);
  const std::size_t last = bytes.size() - 26;
  bytes[last + 14] = '\x12';  // the second of two returns
  bytes[last + 15] = '\x02';  // ground
  bytes[last + 18] = '\x07';
  const Scan scan = io::read_scan(folder.write("a.las", bytes), 0);
  EXPECT_EQ(scan.notes,
            std::vector<std::string>{"fields not used: return numbers, classification, point source"});
}

TEST(Las, AnExtentThatIsNotThatOfThePointsIsToldAsDamage) {
  const ScanFolder folder;
  std::string bytes = las_sample(2);
  bytes.replace(179, 8, raw(0.5));
  const Scan scan = io::read_scan(folder.write("a.las", bytes), 0);
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_TRUE(holds(scan.notes[0], "the header gives x from -3 to 0.5, its points lie from -3 to 1.5"));
}

struct BadHeader {
  const char* what;
  std::size_t at;
  std::string bytes;
  const char *place, *expected;
};

TEST(Las, BadHeadersAreNamed) {
  const auto u16 = [](int value) { return raw(static_cast<std::uint16_t>(value)); };
  const auto u32 = [](std::uint32_t value) { return raw(value); };
  const BadHeader kBad[] = {
      {"signature", 0, "LASX", "byte 0", "\"LASX\""},
      {"version", 25, "\x05", "byte 24", "1.5"},
      {"header size", 94, u16(100), "byte 94", "at least 227"},
      {"header beyond the file", 94, u16(60000), "byte 94", "found 60000"},
      {"points beyond the file", 96, u32(4'000'000'000), "byte 96", "4000000000"},
      {"points within the header", 96, u32(100), "byte 96", "found byte 100"},
      {"records that are not there", 100, u32(4'000'000'000), "record 2 of 4000000000", "bytes left"},
      {"point format 11", 104, "\x0b", "byte 104", "found 11"},
      {"point format 200", 104, "\xc8", "byte 104", "LAZ"},
      {"point format 255", 104, "\xff", "byte 104", "found 255"},
      {"LAZ", 104, "\x82", "byte 104", "laszip"},
      {"short records", 105, u16(20), "byte 105", "at least 26"},
      {"long records", 105, u16(65535), "byte 107", "room for 0"},
      {"too many points", 107, u32(5), "byte 107", "room for 4"},
      {"too few points", 107, u32(3), "points after 3", "room for 1"},
      {"scale 0", 131, raw(0.0), "byte 131", "found 0"},
      {"negative scale", 139, raw(-0.001), "byte 139", "found -0.001"},
      {"scale without measure", 147, raw(1e300), "byte 147", "found 1e+300"},
      {"offset without measure", 163, raw(-1e300), "byte 163", "found -1e+300"},
  };
  const ScanFolder folder;
  for (const BadHeader& bad : kBad) {
    SCOPED_TRACE(bad.what);
    std::string bytes = las_sample(2);
    const auto file = folder.write("bad.las", bytes.replace(bad.at, bad.bytes.size(), bad.bytes));
    expect_input_error([&] { io::read_scan(file, 0); }, {file.string() + ": ", bad.place, bad.expected});
  }
}

TEST(Las, OfVersion14TheOffsetsBehindThePointsAreChecked) {
  const ScanFolder folder;
  std::string bytes = las_sample(4);
  bytes.replace(235, 12, raw(std::uint64_t{1} << 40) + raw(std::uint32_t{1}));
  const auto file = folder.write("bad.las", bytes);
  expect_input_error([&] { io::read_scan(file, 0); },
                     {"byte 235", "extended records", "found them at byte 1099511627776"});
  bytes.replace(235, 12, raw(std::uint64_t{0}) + raw(std::uint32_t{0}));
  bytes.replace(107, 4, raw(std::uint32_t{3}));
  folder.write("bad.las", bytes);
  expect_input_error([&] { io::read_scan(file, 0); }, {"byte 107", "expected 4 points as at byte 247"});
}

TEST(Las, ACompressorsRecordIsRefused) {
  const ScanFolder folder;
  std::string bytes = las_sample(2);
  const auto file = folder.write("a.las", bytes.replace(227 + 2, 15, "laszip encoded\0", 15));
  expect_input_error([&] { io::read_scan(file, 0); }, {"laszip encoded", "decompress it first"});
}

}  // namespace
}  // namespace hybrid::testing::las_test
