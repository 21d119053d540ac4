#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cmath>
#include <limits>

#include "io/read_scan.hpp"
#include "io/scan_files.hpp"

// Formats x damage: one clear ErrorKind::input each, naming the file and the place.
namespace hybrid::testing {
namespace {

struct Format {
  std::string name, data_kind;
  std::string place;               // how messages about the data name their place
  std::string huge_from, huge_to;  // makes the header promise more points than can be there
  bool text() const { return data_kind == "ascii" || name == "ptx"; }
};

const Format kFormats[] = {
    {"pcd", "ascii", "line", "WIDTH 4\nHEIGHT 1", "WIDTH 4000000000\nHEIGHT 1"},
    {"pcd", "binary", "byte", "WIDTH 4\nHEIGHT 1", "WIDTH 4000000000\nHEIGHT 1"},
    {"pcd", "binary_compressed", "byte", "WIDTH 4\nHEIGHT 1", "WIDTH 4000000000\nHEIGHT 1"},
    {"ply", "ascii", "line", "vertex 4", "vertex 18000000000000000000"},
    {"ply", "binary_little_endian", "byte", "vertex 4", "vertex 18000000000000000000"},
    {"ply", "binary_big_endian", "byte", "vertex 4", "vertex 18000000000000000000"},
    {"ptx", "", "line", "2\n2\n", "2000000000\n2000000000\n"},
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
    expect_input_error([&] { io::read_scans(file); }, all);
  }

  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  // With every line end of the header (ascii: of the file) turned into `end`.
  std::string with_line_ends(const std::vector<std::string>& ends) const {
    const std::string text = sample();
    const std::string last =
        GetParam().name == "ply" ? "end_header\n" : "DATA " + GetParam().data_kind + "\n";
    const std::size_t header = GetParam().text() ? text.size() : text.find(last) + last.size();
    std::string result;
    std::size_t lines = 0;
    for (std::size_t i = 0; i < header; ++i) {
      if (text[i] == '\n')
        result += ends[lines++ % ends.size()];
      else
        result += text[i];
    }
    return result + text.substr(header);
  }

  void expect_sample(const std::string& bytes) const {
    const auto scans = io::read_scans(folder_.write(file_name(), bytes));
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

TEST_P(ScanDamage, LineEndsAndUtf8MarkDoNotMatter) {
  expect_sample(with_line_ends({"\r\n"}));
  if (GetParam().text() || GetParam().name == "ply") expect_sample(with_line_ends({"\r"}));
  expect_sample(with_line_ends({"\n", "\r\n"}));
  expect_sample("\xef\xbb\xbf" + sample());
  if (GetParam().text())
    expect_sample(sample().substr(0, sample().size() - 1));  // the last line without its end
}

TEST_P(ScanDamage, Empty) {
  expect_error("", {"byte 0", "empty"});
}

TEST_P(ScanDamage, OnlyBlankLines) {
  expect_error("\n\n  \n", {"line", "expected"});
}

TEST_P(ScanDamage, WrongMagic) {
  expect_error("\x89PNG\r\n\x1a\n0000000000", {"line 1", "expected", "x89PNG"});
}

TEST_P(ScanDamage, Utf16) {
  std::string wide = "\xff\xfe";
  for (const char c : sample()) wide += std::string{c, '\0'};
  expect_error(wide, {"byte 0", "UTF-16", "UTF-8"});
}

TEST_P(ScanDamage, Missing) {
  const auto file = folder_.path("none." + GetParam().name);
  expect_input_error([&] { io::read_scans(file); }, {file.string(), "no such file"});
}

TEST_P(ScanDamage, Folder) {
  const auto file = folder_.path("folder." + GetParam().name);
  std::filesystem::create_directory(file);
  expect_input_error([&] { io::read_scans(file); }, {file.string(), "folder"});
}

TEST_P(ScanDamage, Pipe) {
  const auto file = folder_.path("pipe." + GetParam().name);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  expect_input_error([&] { io::read_scans(file); }, {file.string(), "regular file"});
}

// In a process of its own, which gives up the super-user's right to read everything.
TEST_P(ScanDamage, Unreadable) {
  const auto file = folder_.write(file_name(), sample());
  std::filesystem::permissions(file, std::filesystem::perms::none);
  const pid_t child = fork();
  if (child == 0) {  // _exit: the destructors of static objects belong to the parent
    if (geteuid() == 0 && setuid(65534) != 0) _exit(2);
    try {
      io::read_scans(file);
    } catch (const Error& error) {
      const bool named = std::string(error.what()).find(file.string() + ": cannot be read") == 0;
      _exit(named && error.kind() == ErrorKind::input ? 0 : 1);
    }
    _exit(3);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_P(ScanDamage, CountsBeyondTheFileAreFoundBeforeAllocation) {
  const Format& format = GetParam();
  std::string bytes = replaced(sample(), format.huge_from, format.huge_to);
  if (format.name == "pcd") bytes = replaced(bytes, "POINTS 4", "POINTS 4000000000");
  expect_error(bytes, {format.name == "pcd" ? format.place : "line", "expected",
                       format.name == "ply" ? "18000000000000000000" : "000000000", "found"});
}

TEST_P(ScanDamage, CutAtTenPlaces) {
  const std::string bytes = sample();
  for (std::size_t i = 0; i < 10; ++i) {
    // Text cut within its last number cannot be told from another number: the last cut takes whole ones.
    const std::size_t size = i * (bytes.size() - (GetParam().text() ? 10 : 1)) / 9;
    SCOPED_TRACE(size);
    expect_error(bytes.substr(0, size), {i == 0 ? "byte 0" : "expected"});
    if (i > 0) expect_error(bytes.substr(0, size), {GetParam().text() ? "line " : " "});
  }
}

TEST_P(ScanDamage, ExtraDataIsNotedOrRefused) {
  const std::string bytes = sample() + "9 9 9 0.5 1 1 1\n";
  if (GetParam().name == "ptx") {  // where another scan may follow, extra points mean a wrong header
    expect_error(bytes, {"line 15", "number of columns", "found 7"});
    return;
  }
  const auto scans = io::read_scans(folder_.write(file_name(), bytes));
  ASSERT_EQ(scans.at(0).points.size(), 4u);
  ASSERT_EQ(scans[0].notes.size(), 1u);
  EXPECT_NE(scans[0].notes[0].find("16 bytes"), std::string::npos) << scans[0].notes[0];
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

TEST_P(ScanDamage, NonFinitePointsAreNoReturnsAndNoted) {
  std::string bytes = sample();
  if (GetParam().text()) {
    bytes = replaced(bytes, "1.5 0 0.25", "nan 0 0.25");
  } else {
    const bool big = GetParam().data_kind == "binary_big_endian";
    bytes = replaced(bytes, raw(1.5f, big), raw(std::numeric_limits<float>::infinity(), big));
  }
  const auto scans = io::read_scans(folder_.write(file_name(), bytes));
  for (const float value : scans.at(0).points.at(0)) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(scans[0].points[1][1], 2);
  ASSERT_EQ(scans[0].notes.size(), 1u);
  EXPECT_NE(scans[0].notes[0].find("1 of 4 points are not finite"), std::string::npos) << scans[0].notes[0];
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
    expect_input_error([&] { io::read_scans(file); }, {file.string() + ": ", bad.place, bad.expected});
  }
}

TEST(ScanHeader, OtherExtensionsAreNamedWithTheSupportedOnes) {
  const ScanFolder folder;
  for (const char* name : {"a.e57", "a.LAS", "a.laz", "a.exr", "a.xyz", "noextension"}) {
    const auto file = folder.write(name, "something");
    expect_input_error([&] { io::read_scans(file); }, {file.string(), ".pcd, .ply or .ptx"});
  }
  expect_input_error([&] { io::read_scans(folder.path("a.e57")); }, {"coming"});
  EXPECT_EQ(io::read_scans(folder.write("UPPER.PTX", sample_file("ptx", ""))).size(), 1u);
}

}  // namespace
}  // namespace hybrid::testing
