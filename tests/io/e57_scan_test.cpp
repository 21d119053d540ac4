#include <gtest/gtest.h>

#include <cmath>

#include "io/e57_scans.hpp"

namespace hybrid::testing {
namespace {

class E57Scans : public ::testing::Test {
 protected:
  Scan read(const io::E57Scan& scan, const E57Columns& columns) const {
    const auto file = folder_.path() / "west.e57";
    write_e57(file, scan, columns);
    return io::read_e57(file).at(0);
  }
  static std::string all(const Scan& scan) {
    std::string text;
    for (const std::string& note : scan.notes) text += note + "\n";
    return text;
  }
  TemporaryFolder folder_;
};

io::E57Scan cartesian() {
  io::E57Scan scan;
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(real_field(name, io::E57Type::double_real));
  return scan;
}

TEST_F(E57Scans, SphericalOnesBecomeCartesian) {
  io::E57Scan scan;
  for (const char* name : {"sphericalRange", "sphericalAzimuth", "sphericalElevation"})
    scan.points.fields.push_back(real_field(name, io::E57Type::double_real));
  scan.points.fields.push_back(integer_field("sphericalInvalidState", 0, 2));
  const double quarter = std::acos(-1) / 2;
  const Scan found = read(scan, {{{}, {}, {}, {0, 0, 0, 2, 1}},
                                 {{2, 3, 4, 5, 6}, {0, quarter, 1, 0, 0}, {0, 0, quarter, 0, 0}, {}}});
  EXPECT_NEAR((found.point(0) - Vec3(2, 0, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((found.point(1) - Vec3(0, 3, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((found.point(2) - Vec3(0, 0, 4)).norm(), 0, 1e-6);  // elevation counts from the XY plane
  EXPECT_TRUE(std::isnan(found.points[3][0]) && std::isnan(found.points[4][0]));
}

TEST_F(E57Scans, GeoreferencedOnesKeepTheirPrecision) {
  E57Columns columns{{{}, {}, {}}, {{}, {}, {}}};
  for (int i = 0; i < 1000; ++i) {
    columns.reals[0].push_back(i % 10 == 3 ? NAN : 512'345.0625 + i * 0.0625);
    columns.reals[1].push_back(5'403'210.5);
    columns.reals[2].push_back(i == 7 ? 1e300 : 40);
  }
  const Scan found = read(cartesian(), columns);
  for (std::size_t i = 0; i < 1000; ++i)
    if (i % 10 == 3 || i == 7)
      EXPECT_TRUE(std::isnan(found.points[i][0]));
    else
      EXPECT_NEAR((found.point(i) - Vec3(columns.reals[0][i], columns.reals[1][i], 40)).norm(), 0, 1e-4) << i;
  EXPECT_TRUE(holds(all(found), "coordinates are large"));
  EXPECT_TRUE(holds(all(found), "101 of 1000 points are not finite"));
}

// Rows x columns of a grid; samples at the given nodes, whose x tells the sample.
Scan on_grid(const std::function<Scan(const io::E57Scan&, const E57Columns&)>& read,
             const std::vector<std::array<int, 3>>& row_column_return, int limit = 100) {
  io::E57Scan scan = cartesian();
  scan.points.fields.push_back(integer_field("rowIndex", -5, limit));
  scan.points.fields.push_back(integer_field("columnIndex", 0, limit));
  scan.points.fields.push_back(integer_field("returnIndex", 0, 3));
  E57Columns columns{{{}, {}, {}, {}, {}, {}}, {{}, {}, {}, {}, {}, {}}};
  for (const auto& [row, column, back] : row_column_return) {
    columns.reals[0].push_back(static_cast<double>(columns.reals[0].size() + 1));
    columns.reals[1].push_back(1);
    columns.reals[2].push_back(1);
    columns.integers[3].push_back(row);
    columns.integers[4].push_back(column);
    columns.integers[5].push_back(back);
  }
  return read(scan, columns);
}

TEST_F(E57Scans, GridsInOrderNeedNoNodes) {
  const auto read_it = [&](const auto& scan, const auto& columns) { return read(scan, columns); };
  std::vector<std::array<int, 3>> by_column, by_row;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 4; ++b) {
      by_column.push_back({b + 2, a + 7, 0});
      by_row.push_back({a, b, 0});
    }
  const Scan columns = on_grid(read_it, by_column), rows = on_grid(read_it, by_row);
  EXPECT_EQ(columns.grid_rows, 4);
  EXPECT_EQ(columns.grid_cols, 3);
  EXPECT_TRUE(columns.node.empty() && !columns.row_by_row);
  EXPECT_EQ(columns.grid_index(1, 2), 9u);
  EXPECT_EQ(rows.grid_rows, 3);
  EXPECT_TRUE(rows.node.empty() && rows.row_by_row);
}

TEST_F(E57Scans, SparseGridsInAnyOrderHaveNodes) {
  const auto read_it = [&](const auto& scan, const auto& columns) { return read(scan, columns); };
  const Scan scan = on_grid(read_it, {{4, 9, 0}, {-1, 8, 0}, {2, 7, 1}, {2, 7, 0}, {2, 8, 1}});
  EXPECT_EQ(scan.grid_rows, 6);
  EXPECT_EQ(scan.grid_cols, 3);
  // The second return of a node gives way to the first wherever they come; alone it takes the node.
  EXPECT_EQ(scan.node, (std::vector<std::uint32_t>{17, 1, Scan::kNoNode, 9, 10}));
}

TEST_F(E57Scans, IndicesOutsideWhatIsDeclared) {
  io::E57Scan scan = cartesian();
  scan.rows = io::E57Limits{0, 1};  // not true
  scan.columns = io::E57Limits{0, 1};
  scan.points.fields.push_back(integer_field("rowIndex", std::numeric_limits<std::int64_t>::min(),
                                             std::numeric_limits<std::int64_t>::max()));
  scan.points.fields.push_back(integer_field("columnIndex", 0, 100));
  const Scan found = read(
      scan, {{{}, {}, {}, {1'000'000'000'000, 1'000'000'000'001}, {3, 9}}, {{1, 2}, {1, 2}, {1, 2}, {}, {}}});
  EXPECT_EQ(found.grid_rows, 2);
  EXPECT_EQ(found.grid_cols, 7);
  EXPECT_EQ(found.node, (std::vector<std::uint32_t>{0, 13}));
  // Two samples at the ends of a grid that no memory holds.
  const Scan wide = read(scan, {{{}, {}, {}, {-1'000'000'000'000, 1'000'000'000'001}, {3, 9}},
                                {{1, 2}, {1, 2}, {1, 2}, {}, {}}});
  EXPECT_FALSE(wide.organised());
  EXPECT_TRUE(holds(all(wide), "not organised"));
}

TEST_F(E57Scans, ColoursByTheirLimits) {
  io::E57Scan scan = cartesian();
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
    scan.points.fields.push_back(integer_field(name, 0, 65535));
  const auto with = [&](std::int64_t least, std::int64_t middle, std::int64_t most) {
    const std::vector<std::int64_t> values = {least, middle, most};
    return read(scan, {{{}, {}, {}, values, values, values}, {{1, 2, 3}, {1, 1, 1}, {1, 1, 1}, {}, {}, {}}});
  };
  using Rgb = std::array<std::uint8_t, 3>;
  EXPECT_EQ(with(0, 128, 255).rgb[1], (Rgb{128, 128, 128}));       // words that hold bytes
  EXPECT_EQ(with(0, 0x8080, 65535).rgb[1], (Rgb{128, 128, 128}));  // words
  scan.colour = std::array{io::E57Limits{100, 300}, io::E57Limits{0, 400}, io::E57Limits{200, 200}};
  const Scan limited = with(100, 180, 300);
  EXPECT_EQ(limited.rgb[0], (Rgb{0, 64, 0}));
  EXPECT_EQ(limited.rgb[1], (Rgb{102, 115, 0}));
  EXPECT_EQ(limited.rgb[2], (Rgb{255, 191, 0}));
}

TEST_F(E57Scans, OneOfManyAndItsName) {
  const auto file = folder_.path() / "site.e57";
  io::E57Writer writer(file);
  for (int i = 0; i < 3; ++i) {
    writer.begin_scan(cartesian());
    writer.write(E57Columns{{{}, {}, {}}, {{i + 1.0}, {1}, {1}}}.records());
    writer.end_scan();
  }
  writer.close();
  const io::E57File site(file);
  EXPECT_EQ(io::read_e57(site, 1).points[0][0], 2);
  EXPECT_EQ(io::read_e57(site, 1).name, "site-1");
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::read_e57(site, 3); }), "found 3 scans"));
  // Without reading the others: the first one is gone.
  std::string bytes = bytes_of(file);
  bytes = overwritten(bytes, 48, "\x09");
  EXPECT_EQ(io::read_e57(io::E57File(folder_.write("bad.e57", bytes)), 2).points[0][0], 3);
  io::E57Scan none;
  none.points.fields = {integer_field("intensity", 0, 3)};
  EXPECT_TRUE(holds(error_of(ErrorKind::input,
                             [&] {
                               read(none, {{{1}}, {{}}});
                             }),
                    "expected cartesianX, Y and Z"));
}

}  // namespace
}  // namespace hybrid::testing
