// Texts of points, with and without the names of their columns.
#include "io/text/xyz.hpp"

#include <gtest/gtest.h>

#include "io/read_scan.hpp"
#include "io/same_in_blocks.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

using Points = std::vector<std::array<float, 3>>;
using Colours = std::vector<std::array<std::uint8_t, 3>>;
const Points kTwo = {{1, 2, 3}, {4, 5, 6}};

Scan read(const ScanFolder& folder, const std::string& text, const std::string& name = "a.xyz") {
  return io::read_scan(folder.write(name, text), 0);
}

TEST(Xyz, SeparatorsAndEndings) {
  const ScanFolder folder;
  for (const char* text : {"1 2 3\n4 5 6\n", "1\t2\t3\r\n4\t5\t6", "1,2,3\n\n4,5,6\n", "1;2;3\n4; 5; 6\n",
                           "# by someone\n// 1,5 m 2 apart\n1 2 3\n4 5 6\n", "2\n1 2 3\n4 5 6\n"}) {
    EXPECT_EQ(read(folder, text).points, kTwo) << text;
    EXPECT_EQ(read(folder, text, "a.csv").points, kTwo) << text;
  }
  for (const char* name : {"a.ASC", "a.txt"})
    EXPECT_EQ(read(folder, "1 2 3\n4 5 6\n", name).points, kTwo) << name;
}

TEST(Xyz, ColumnsWithoutNames) {
  const ScanFolder folder;
  struct Row {
    const char* text;
    std::vector<float> intensity;
    Colours rgb;
    std::size_t notes;
  };
  const Row rows[] = {
      {"1 2 3 0.5\n4 5 6 7\n", {0.5f, 7}, {}, 0},
      {"1 2 3 10 20 30\n4 5 6 40 50 255\n", {}, {{10, 20, 30}, {40, 50, 255}}, 0},
      {"1 2 3 0.7 10 20 30\n4 5 6 0.8 40 50 60\n", {0.7f, 0.8f}, {{10, 20, 30}, {40, 50, 60}}, 0},
      {"1 2 3 10 20 30 0.7\n4 5 6 40 50 60 1200\n", {0.7f, 1200}, {{10, 20, 30}, {40, 50, 60}}, 0},
      {"1 2 3 9 10 20 30\n4 5 6 8 40 50 60\n", {9, 8}, {{10, 20, 30}, {40, 50, 60}}, 1},  // or the other way
      {"1 2 3 0 0 1\n4 5 6 0 0.5 0.8\n", {}, {}, 1},                                      // normals
      {"1 2 3 4 5\n4 5 6 7 8\n", {}, {}, 1},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.text);
    const Scan scan = read(folder, row.text);
    EXPECT_EQ(scan.points, kTwo);
    EXPECT_EQ(scan.intensity, row.intensity);
    EXPECT_EQ(scan.rgb, row.rgb);
    EXPECT_EQ(scan.notes.size(), row.notes);
  }
  EXPECT_NE(read(folder, rows[6].text).notes[0].find("columns not used: column 4, column 5"),
            std::string::npos);
}

TEST(Xyz, NamesOfColumns) {
  const ScanFolder folder;
  const Colours rgb = {{10, 20, 30}, {40, 50, 60}};
  // As CloudCompare and PDAL write them, and spreadsheets.
  Scan scan = read(folder, "//X Y Z R G B Intensity Nx\n2\n1 2 3 10 20 30 0.5 0.1\n4 5 6 40 50 60 0.6 0.2\n");
  EXPECT_EQ(scan.points, kTwo);
  EXPECT_EQ(scan.rgb, rgb);
  EXPECT_EQ(scan.intensity, (std::vector<float>{0.5f, 0.6f}));
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_EQ(scan.notes[0], "columns not used: nx");
  scan =
      read(folder,
           "\"GpsTime\",\"Red\",\"Green\",\"Blue\",\"Z\",\"Y\",\"X\"\n9,10,20,30,3,2,1\n9,40,50,60,6,5,4\n");
  EXPECT_EQ(scan.points, kTwo);
  EXPECT_EQ(scan.rgb, rgb);
  scan = read(folder, "Easting[m];Northing[m];Height[m];Reflectance(dB)\n1;2;3;-4\n4;5;6;-5\n");
  EXPECT_EQ(scan.points, kTwo);
  EXPECT_EQ(scan.intensity, (std::vector<float>{-4, -5}));
  EXPECT_TRUE(scan.notes.empty());
  scan = read(folder, "x y z red\n1 2 3 10\n4 5 6 20\n");  // no colour is that
  EXPECT_TRUE(scan.rgb.empty());
  EXPECT_EQ(scan.notes, std::vector<std::string>{"columns not used: red"});
  // Other ranges of colours.
  EXPECT_EQ(read(folder, "x y z r g b\n1 2 3 0 0.5 1\n4 5 6 0.25 0 0\n").rgb,
            (Colours{{0, 128, 255}, {64, 0, 0}}));
  EXPECT_EQ(read(folder, "x y z r g b\n1 2 3 0 25700 65535\n4 5 6 257 0 0\n").rgb,
            (Colours{{0, 100, 255}, {1, 0, 0}}));
}

TEST(Xyz, NoPoints) {
  const ScanFolder folder;
  for (const char* text : {"//X Y Z\n", "//X Y Z R G B\n0\n", "0\n"}) {
    const Scan scan = read(folder, text);
    EXPECT_TRUE(scan.points.empty()) << text;
    EXPECT_EQ(scan.notes, std::vector<std::string>{"no points"}) << text;
  }
}

TEST(Xyz, WrongLinesAreNamed) {
  const ScanFolder folder;
  const struct {
    const char *text, *place, *expected;
  } bad[] = {
      {"hello\n", "line 1", "the names of columns with x, y and z among them, found \"hello\""},
      {"x y\n1 2\n", "line 1", "found \"x y\""},
      {"x y z i\n1 2 3\n", "line 2", "expected 4 numbers, as line 1 has names, found 3"},
      {"1 2\n", "line 1", "3 to 64 numbers"},
      {"# nothing\n", "line 2", "expected points, found the end"},
      {"x y z\n2\n", "line 3", "expected points, found the end"},
      {"1 2 3\n4 5\n", "line 2", "expected 3 numbers as on line 1, found 2"},
      {"1 2 3\n4 x 6\n", "line 2", "\"x\""},
      {"3\n1 2 3\n4 5 6\n", "line 1", "expected 3 points as it says, found 2"},
      {"x y z\n1\n1 2 3\n4 5 6\n", "line 2", "expected 1 points as it says, found 2"},
      {"0\n1 2 3\n", "line 1", "expected 0 points as it says, found 1"},
      {"0,5 1,5 2,5\n", "line 1", "decimal points, found \"0,5\""},
      {"x y z\n0,5 1,5 2,5\n", "line 2", "decimal points, found \"0,5\""},
      {"0,5;1,5;2,5\n", "line 1", "decimal points, found \"0,5\""},
  };
  for (const auto& row : bad) {
    SCOPED_TRACE(row.text);
    const auto file = folder.write("bad.xyz", row.text);
    expect_input_error([&] { io::read_scan(file, 0); }, {file.string() + ": ", row.place, row.expected});
  }
}

TEST(Xyz, SalvageTakesWhatIsGood) {
  const ScanFolder folder;
  const auto file = folder.write("a.xyz", "4\n1 2 3\nlost\n4 5 6\n");
  const auto entries = io::list_scans(file, {.salvage = true});
  const Scan scan = io::read_scan(file, entries.at(0));
  ASSERT_EQ(scan.points.size(), 3u);
  EXPECT_EQ(scan.points[2], kTwo[1]);
  EXPECT_TRUE(std::isnan(scan.points[1][0]));
  ASSERT_EQ(scan.notes.size(), 1u);
  EXPECT_NE(scan.notes[0].find("2 of 4 points"), std::string::npos) << scan.notes[0];
}

TEST(Xyz, IsAScanOfAFolderByItsExtensionAlone) {
  EXPECT_TRUE(io::has_scan_extension("cloud.XYZ"));
  for (const char* name : {"readme.txt", "table.csv", "terrain.asc"})
    EXPECT_FALSE(io::has_scan_extension(name)) << name;
}

}  // namespace
}  // namespace hybrid::testing
