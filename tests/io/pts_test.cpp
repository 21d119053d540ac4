#include "io/text/pts.hpp"

#include <gtest/gtest.h>

#include "io/read_scans.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

TEST(Pts, ColumnsTellWhatThereIs) {
  const ScanFolder folder;
  const struct {
    const char* line;
    bool intensity, colour;
  } kinds[] = {{"1 2 3", false, false},
               {"1 2 3 -7", true, false},
               {"1 2 3 4 5 6", false, true},
               {"1 2 3 -7 4 5 6", true, true}};
  for (const auto& kind : kinds) {
    SCOPED_TRACE(kind.line);
    const Scan scan =
        io::read_scan(folder.write("a.pts", fmt::format("2\n{}\n{}\n", kind.line, kind.line)), 0);
    EXPECT_EQ(scan.points, (std::vector<std::array<float, 3>>{{1, 2, 3}, {1, 2, 3}}));
    EXPECT_EQ(scan.intensity, kind.intensity ? std::vector<float>({-7, -7}) : std::vector<float>());
    EXPECT_EQ(scan.rgb.size(), kind.colour ? 2u : 0u);
    if (kind.colour) {
      EXPECT_EQ(scan.rgb[1], (std::array<std::uint8_t, 3>{4, 5, 6}));
    }
    EXPECT_EQ(scan.intensity_limits.has_value(), kind.intensity);
    EXPECT_FALSE(scan.organised());
  }
}

TEST(Pts, CountsAreScans) {
  const ScanFolder folder;
  const auto file = folder.write("two.pts", "2\n1 2 3\n4 5 6\n\n0\n1\n7 8 9 10\n");
  const auto scans = read_scans(file);
  ASSERT_EQ(scans.size(), 3u);
  EXPECT_EQ(scans[0].name, "two-0");
  EXPECT_EQ(scans[0].points.size(), 2u);
  EXPECT_TRUE(scans[1].points.empty());
  EXPECT_EQ(scans[2].points[0], (std::array<float, 3>{7, 8, 9}));
  EXPECT_EQ(scans[2].intensity, std::vector<float>{10});
}

TEST(Pts, TheCountMayBeMissing) {
  const ScanFolder folder;
  const Scan scan = io::read_scan(folder.write("a.pts", "1 2 3\n4 5 6"), 0);
  EXPECT_EQ(scan.name, "a");
  EXPECT_EQ(scan.points.size(), 2u);
}

TEST(Pts, ColoursThatAreNoBytesAreNoted) {
  const ScanFolder folder;
  const Scan good = io::read_scan(folder.write("a.pts", "1 2 3 0 255 7\n4 5 6 1 2 3\n"), 0);
  EXPECT_TRUE(good.notes.empty());
  const Scan scan =
      io::read_scan(folder.write("b.pts", "1 2 3 4 20 30 0.5\n1 2 3 4 30 20 1000\n4 5 6 4 1 2 3\n"), 0);
  EXPECT_EQ(scan.rgb[1], (std::array<std::uint8_t, 3>{30, 20, 255}));
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_NE(scan.notes[0].find("2 of 3 points have a colour"), std::string::npos) << scan.notes[0];
}

// Commas separate where nothing else does.
TEST(Pts, CommasSeparateNumbers) {
  const ScanFolder folder;
  for (const char* text : {"1,2,3\n4,5,6\n", "1, 2, 3\n4 , 5 , 6\n", "1,2, 3\n4,5,6\n"}) {
    const Scan scan = io::read_scan(folder.write("a.pts", text), 0);
    EXPECT_EQ(scan.points, (std::vector<std::array<float, 3>>{{1, 2, 3}, {4, 5, 6}})) << text;
  }
}

TEST(Pts, WrongLinesAreNamed) {
  const ScanFolder folder;
  const struct {
    const char *text, *place, *expected;
  } bad[] = {
      {"2\n1 2 3.5\n\n\n\n", "line 6", "2 points as line 1 says, found 1"},
      {"9\n1 2 3\n", "line 1", "room for 1"},
      {"1\n1 2 3\n4 5 6\n", "line 3", "correct the count"},
      {"2\n1 2 3\n4 5 6 7\n", "line 3", "(3 numbers)"},
      {"2\n1 2 3\n4 x 6\n", "line 3", "\"x\""},
      {"2.5\n1 2 3\n", "line 1", "found 2.5"},
      {"-1\n1 2 3\n", "line 1", "found -1"},
      {"1\n1.25 2.5\n", "line 2", "found 2"},
      {"1 2\n", "line 1", "3, 4, 6 or 7"},
      {"1\n1 2 3 4 5 6 7 8\n", "line 2", "found 8"},
      {"hello\n", "line 1", "\"hello\""},
      {"2\n0,25 1,5 -3,0\n1,0 2,0 3,0\n", "line 2", "decimal points, found \"0,25\""},
      {"1\t2,5\t3\n", "line 1", "decimal points, found \"2,5\""},
  };
  for (const auto& row : bad) {
    SCOPED_TRACE(row.text);
    const auto file = folder.write("bad.pts", row.text);
    expect_input_error([&] { read_scans(file); }, {file.string() + ": ", row.place, row.expected});
  }
}

}  // namespace
}  // namespace hybrid::testing
