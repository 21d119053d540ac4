#include <gtest/gtest.h>

#include "io/read_scans.hpp"
#include "io/scan_files.hpp"

// What scans add to the table of bad input: wrong header lines, values that are no numbers, data left over.
namespace hybrid::testing::scan_damage_test {
namespace {

struct Format {
  std::string name, data_kind;
  std::string place;  // how messages about the data name their place
  bool text() const { return data_kind == "ascii" || data_kind.empty(); }
};

const Format kFormats[] = {
    {"pcd", "ascii", "line"},
    {"pcd", "binary", "byte"},
    {"pcd", "binary_compressed", "byte"},
    {"ply", "ascii", "line"},
    {"ply", "binary_little_endian", "byte"},
    {"ply", "binary_big_endian", "byte"},
    {"ptx", "", "line"},
};

void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name << ' ' << format.data_kind;
}

class ScanDamage : public ::testing::TestWithParam<Format> {
 protected:
  std::string sample() const { return sample_file(GetParam().name, GetParam().data_kind); }
  std::string file_name() const { return "west wall \xc3\xbc." + GetParam().name; }

  void expect_error(const std::string& bytes, const std::vector<std::string>& parts) const {
    const auto file = folder_.write(file_name(), bytes);
    std::vector<std::string> all = parts;
    all.insert(all.begin(), file.string() + ": ");
    expect_input_error([&] { read_scans(file); }, all);
  }

  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  void expect_sample(const std::string& bytes) const {
    const auto scans = read_scans(folder_.write(file_name(), bytes));
    ASSERT_EQ(scans.size(), 1u);
    ASSERT_EQ(scans[0].points.size(), 4u);
    ASSERT_EQ(scans[0].intensity.size(), 4u);
    ASSERT_EQ(scans[0].rgb.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(scans[0].intensity[i], kSampleIntensity[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(scans[0].points[i][k], kSamplePoints[i][k]) << i;
        EXPECT_EQ(scans[0].rgb[i][k], kSampleRgb[i][k]) << i;
      }
    }
    EXPECT_EQ(scans[0].name, "west wall \xc3\xbc");
  }

  ScanFolder folder_;
};

TEST_P(ScanDamage, IntactFileReads) {
  expect_sample(sample());
}

// Half a point; a whole one would mean that the header is wrong.
TEST_P(ScanDamage, ExtraDataIsNotedOrRefused) {
  const std::string bytes = sample() + "9 9 9\n";
  if (GetParam().name == "ptx") {  // where another scan may follow, extra points mean a wrong header
    expect_error(bytes, {"line 15", "number of columns", "found 3"});
    return;
  }
  const auto scans = read_scans(folder_.write(file_name(), bytes));
  ASSERT_EQ(scans.at(0).points.size(), 4u);
  ASSERT_EQ(scans[0].notes.size(), 1u);
  EXPECT_NE(scans[0].notes[0].find("6 bytes"), std::string::npos) << scans[0].notes[0];
  EXPECT_NE(scans[0].notes[0].find(GetParam().place), std::string::npos) << scans[0].notes[0];
}

// Binary data has neither lines nor bytes that are no number.
class TextScanDamage : public ScanDamage {};

TEST_P(TextScanDamage, NoNumberInTheData) {
  const char* line = GetParam().name == "ptx" ? "line 12" : "line 13";
  expect_error(replaced(sample(), "0 2 -0.5", "0 two -0.5"), {line, "expected a number", "two"});
}

TEST_P(TextScanDamage, WrongNumberOfValues) {
  expect_error(replaced(sample(), "0 2 -0.5", "0 2 0 -0.5"), {"line 1", "expected", "found"});
  expect_error(replaced(sample(), "0 2 -0.5", "2 -0.5"), {"line 1", "expected", "found"});
}

std::string test_name(const ::testing::TestParamInfo<Format>& info) {
  return info.param.name + (info.param.data_kind.empty() ? "" : "_" + info.param.data_kind);
}

INSTANTIATE_TEST_SUITE_P(Formats, ScanDamage, ::testing::ValuesIn(kFormats), test_name);
INSTANTIATE_TEST_SUITE_P(Formats, TextScanDamage, ::testing::Values(kFormats[0], kFormats[3], kFormats[6]),
                         test_name);

// A header line replaced by a wrong one: the message names it.
struct BadHeader {
  const char *format, *data_kind, *from, *to, *place, *expected;
};

const BadHeader kBadHeaders[] = {
    {"pcd", "ascii", "VERSION 0.7", "VERSOIN 0.7", "line 2", "VERSOIN"},
    {"pcd", "ascii", "FIELDS x y z", "FIELDS x y w", "FIELDS", "no z"},
    {"pcd", "ascii", "FIELDS x y z", "FIELDS x x z", "FIELDS", "again"},
    {"pcd", "ascii", "FIELDS x y z intensity rgb\n", "", "line 10", "a FIELDS line"},
    {"pcd", "ascii", "SIZE 4 4 4 4 4", "SIZE 4 4 4 4", "line 4", "5 values after SIZE"},
    {"pcd", "ascii", "SIZE 4 4", "SIZE 3 4", "line 5", "TYPE I, U or F"},
    {"pcd", "ascii", "TYPE F", "TYPE Q", "line 5", "Q"},
    {"pcd", "ascii", "COUNT 1 1", "COUNT 1 0", "line 6", "at least 1"},
    {"pcd", "ascii", "WIDTH 4", "WIDTH -4", "line 7", "-4"},
    {"pcd", "ascii", "WIDTH 4\n", "WIDTH 4\nWIDTH 4\n", "line 8", "again"},
    {"pcd", "ascii", "HEIGHT 1", "HEIGHT 2", "line 10", "4 x 2 = 8, found 4"},
    {"pcd", "ascii", "HEIGHT 1", "HEIGHT 9999999999", "line 7", "grid"},
    {"pcd", "ascii", "POINTS 4", "POINTS four", "line 10", "four"},
    {"pcd", "ascii", "DATA ascii", "DATA text", "line 11", "text"},
    {"pcd", "ascii", "0 0 0 1 0 0 0", "0 0 nan 1 0 0 0", "line 9", "finite"},
    {"pcd", "ascii", "0 0 0 1 0 0 0", "0 0 0 0 0 0 0", "line 9", "unit quaternion"},
    {"pcd", "ascii", "0 0 0 1 0 0 0", "0 0 0", "line 9", "7 values"},
    {"ply", "ascii", "ply\n", "plyx\n", "line 1", "plyx"},
    {"ply", "ascii", "format ascii 1.0", "format ascii 2.0", "line 2", "2.0"},
    {"ply", "ascii", "format ascii 1.0\n", "", "line 10", "format"},
    {"ply", "ascii", "element vertex 4", "element vertex -4", "line 3", "-4"},
    {"ply", "ascii", "element vertex 4\n", "", "line 3", "an element before its properties"},
    {"ply", "ascii", "element vertex 4", "element point 4", "line 11", "named vertex"},
    {"ply", "ascii", "element vertex 4\n", "element vertex 4\nelement vertex 4\n", "line 4", "once"},
    {"ply", "ascii", "property float x", "property real x", "line 4", "real"},
    {"ply", "ascii", "property float x", "property float", "line 4", "property TYPE NAME"},
    {"ply", "ascii", "property float y", "property float x", "line 3", "again"},
    {"ply", "ascii", "property float z", "property float w", "line 3", "no z"},
    {"ply", "ascii", "property float z", "property list float float z", "line 6", "whole type"},
    {"ply", "ascii", "property float z", "proprety float z", "line 6", "proprety"},
    {"ply", "ascii", "end_header\n", "", "line 11", "0.25"},
    {"ptx", "", "2\n2\n", "2.5\n2\n", "line 1", "2.5"},
    {"ptx", "", "2\n2\n", "2\n0\n", "line 2", "rows"},
    {"ptx", "", "2\n2\n", "2 2\n", "line 1", "found 2"},
    {"ptx", "", "0 0 0\n", "0 0 0 0\n", "line 3", "position"},
    {"ptx", "", "5 6 7 1", "5 6 7", "line 10", "4x4"},
    {"ptx", "", "5 6 7 1", "5 nan 7 1", "lines 7 to 10", "finite"},
    {"ptx", "", "0 0 1 0\n", "0 0 3 0\n", "lines 7 to 10", "rotation times a scale"},
    {"ptx", "", "1.5 0 0.25 0.5 1 2 3", "1.5 0 0.25 0.5 1", "line 11", "4 or 7"},
};

TEST(ScanHeader, EveryWrongLineIsNamed) {
  const ScanFolder folder;
  for (const BadHeader& bad : kBadHeaders) {
    SCOPED_TRACE(fmt::format("{}: {} -> {}", bad.format, bad.from, bad.to));
    std::string bytes = sample_file(bad.format, bad.data_kind);
    const std::size_t at = bytes.find(bad.from);
    ASSERT_NE(at, std::string::npos);
    const auto file =
        folder.write(fmt::format("bad.{}", bad.format), bytes.replace(at, strlen(bad.from), bad.to));
    expect_input_error([&] { read_scans(file); }, {file.string() + ": ", bad.place, bad.expected});
  }
}

TEST(ScanHeader, OtherExtensionsAreNamedWithTheSupportedOnes) {
  const ScanFolder folder;
  for (const char* name : {"a.laz", "a.abc", "noextension"}) {
    const auto file = folder.write(name, "something");
    expect_input_error([&] { read_scans(file); }, {file.string(), io::scan_extensions()});
  }
  expect_input_error([&] { read_scans(folder.path("a.laz")); }, {"decompress it first"});
  EXPECT_EQ(read_scans(folder.write("UPPER.PTX", sample_file("ptx", ""))).size(), 1u);
}

}  // namespace
}  // namespace hybrid::testing::scan_damage_test
