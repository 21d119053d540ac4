#include "io/text/ptx.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/read_scans.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

constexpr const char* kIdentity = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(Ptx, ColumnsOfRowsWithNoReturns) {
  const ScanFolder folder;
  const auto file =
      folder.write("a.ptx", "2\n3\n" + std::string(kIdentity) +
                                "1 0 -1 0.1\n1 0 0 0.2\n0 0 0 0.5\n0 1 -1 0.3\n0 1 0 0.4\n0 1 1 0.5\n");
  const auto scans = read_scans(file);
  ASSERT_EQ(scans.size(), 1u);
  const Scan& scan = scans[0];
  EXPECT_EQ(scan.name, "a");
  EXPECT_EQ(scan.grid_cols, 2);
  EXPECT_EQ(scan.grid_rows, 3);
  ASSERT_EQ(scan.points.size(), 6u);
  EXPECT_EQ(scan.points[1 * 3 + 2], (std::array<float, 3>{0, 1, 1}));  // column 1, row 2 from the bottom
  for (const float value : scan.points[2]) EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(scan.intensity[3], 0.3f);
  EXPECT_TRUE(scan.rgb.empty());
  EXPECT_FALSE(scan.world_from_scan);  // the identity says nothing
  EXPECT_TRUE(scan.notes.empty());
}

TEST(Ptx, MatrixIsTransposedAndScansAreNumbered) {
  const ScanFolder folder;
  // A quarter turn about Z in row-vector form: (1, 0, 0) goes to (0, 1, 0).
  const std::string turned =
      "1\n2\n10 20 30\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n500010.5 180020.25 30 1\n"
      "1 0 0 0.1 255 0 1\n2 0 0 0.2 300 -4 77\n";
  const auto file = folder.write("two.ptx", turned + "1\n1\n" + kIdentity + "\n 1 2 3 0.5 \n\n");
  const auto scans = read_scans(file);
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_EQ(scans[0].name, "two-0");
  EXPECT_EQ(scans[1].name, "two-1");
  ASSERT_TRUE(scans[0].world_from_scan);
  EXPECT_LT((*scans[0].world_from_scan * Vec3(1, 0, 0) - Vec3(500010.5, 180021.25, 30)).norm(), 1e-9);
  EXPECT_EQ(scans[0].points[1], (std::array<float, 3>{2, 0, 0}));  // still the scanner's frame
  EXPECT_EQ(scans[0].rgb, (std::vector<std::array<std::uint8_t, 3>>{{255, 0, 1}, {255, 0, 77}}));
  EXPECT_FALSE(scans[1].world_from_scan);
  EXPECT_TRUE(scans[1].rgb.empty());
}

TEST(Ptx, APositionBesideTheMatrixIsNamed) {
  const ScanFolder folder;
  std::string text = "1\n1\n100 200 50\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n";
  const auto beside = read_scans(folder.write("beside.ptx", text));
  ASSERT_EQ(beside[0].notes.size(), 1u);
  EXPECT_TRUE(holds(beside[0].notes[0], "line 3: the scanner's position 100 200 50 does not fit the matrix"));
  EXPECT_TRUE(holds(beside[0].notes[0], "`scanner = [100, 200, 50]`"));
  text.replace(text.find("0 0 0 1\n1 2"), 7, "100 200 50 1");
  EXPECT_TRUE(read_scans(folder.write("same.ptx", text))[0].notes.empty());
}

TEST(Ptx, FewerPointsThanPromisedIsFoundAtTheNextHeader) {
  const ScanFolder folder;
  const auto file =
      folder.write("short.ptx", "2\n2\n" + std::string(kIdentity) + "1 0 0 0.1\n1 0 1 0.2\n1 1 0 0.3\n" +
                                    "1\n1\n" + kIdentity + "1 2 3 0.5\n");
  expect_input_error([&] { read_scans(file); }, {file.string(), "line 14", "4 numbers", "found 1"});
}

TEST(Ptx, ColumnsMayNotChangeWithinAScan) {
  const ScanFolder folder;
  const auto file =
      folder.write("mixed.ptx", "1\n2\n" + std::string(kIdentity) + "1 0 0 0.1 1 2 3\n1 0 1 0.2\n");
  expect_input_error([&] { read_scans(file); }, {file.string(), "line 12", "7 numbers", "found 4"});
}

}  // namespace
}  // namespace hybrid::testing
