// What is written reads back as the same values, in each format what it can hold.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "geometry/vectors.hpp"
#include "io/read_scans.hpp"
#include "io/scan_files.hpp"
#include "io/scan_writers.hpp"

namespace hybrid::testing::write_scan_test {
namespace {

// A grid of several blocks with everything a scan can hold; values with all their bits.
Scan full_scan(int rows, int cols, bool row_by_row = false) {
  std::mt19937 random(11);
  const auto real = [&] { return std::ldexp(static_cast<float>(random()), -28) - 8; };
  Scan scan;
  scan.name = "full";
  scan.grid_rows = rows;
  scan.grid_cols = cols;
  scan.row_by_row = row_by_row;
  for (int i = 0; i < rows * cols; ++i) {
    scan.points.push_back(random() % 10 == 0 ? std::array{kNaN, kNaN, kNaN}
                                             : std::array{real(), 1e-6f * real(), 100 * real()});
    scan.intensity.push_back(static_cast<float>(random()) / 4294967296.0f);
    scan.rgb.push_back({static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                        static_cast<std::uint8_t>(random())});
  }
  scan.world_from_scan =
      Pose{1, Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized(), {530000.125, -180000.5, 12.0625}};
  return scan;
}

io::ScanSource source(std::vector<Scan> scans) {
  return [scans, at = std::size_t{0}]() mutable {
    return at < scans.size() ? std::make_unique<io::ScanInMemory>(scans[at++]) : nullptr;
  };
}

io::WriteLosses losses_in(const std::string& name, const Scan& scan) {
  return io::losses_of(io::writer_for(name), io::ScanInMemory(scan));
}

Scan through(const ScanFolder& folder, const std::string& name, const Scan& scan) {
  const auto file = folder.path(name);
  io::writer_for(file).write(file, source({scan}));
  return io::read_scan(file, 0);
}

bool same(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k])))) return false;
  return true;
}

void expect_same_grid(const Scan& a, const Scan& b) {
  ASSERT_EQ(a.grid_rows, b.grid_rows);
  ASSERT_EQ(a.grid_cols, b.grid_cols);
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_EQ(a.intensity.size(), b.intensity.size());
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  for (int row = 0; row < a.grid_rows; ++row)
    for (int col = 0; col < a.grid_cols; ++col) {
      const std::size_t i = a.grid_index(row, col), k = b.grid_index(row, col);
      ASSERT_TRUE(same(a.points[i], b.points[k])) << row << ' ' << col;
      ASSERT_EQ(a.intensity[i], b.intensity[k]);
      ASSERT_TRUE(a.rgb.empty() || a.rgb[i] == b.rgb[k]);
    }
  ASSERT_EQ(a.world_from_scan.has_value(), b.world_from_scan.has_value());
  if (!a.world_from_scan) return;
  const auto apart = difference(*a.world_from_scan, *b.world_from_scan);
  EXPECT_LT(apart.angle_rad, 1e-12);
  EXPECT_EQ(apart.distance_m, 0);
}

// The returns, in file order.
void expect_same_returns(const Scan& written, const Scan& read, double tolerance_m) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < written.points.size(); ++i) {
    if (std::isnan(written.points[i][0])) continue;
    ASSERT_LT(at, read.points.size());
    // What is rounded to steps is then rounded to a float.
    const double slack_m = tolerance_m > 0 ? tolerance_m + written.point(i).norm() * 0x1p-24 : 0;
    ASSERT_LE((written.point(i) - read.point(at)).cwiseAbs().maxCoeff(), slack_m) << i;
    ASSERT_EQ(written.rgb[i], read.rgb[at]);
    ++at;
  }
  EXPECT_EQ(at, read.points.size());
}

TEST(WriteScan, PtxKeepsGridPoseIntensityAndColour) {
  const ScanFolder folder;
  for (const bool row_by_row : {false, true}) {
    const Scan scan = full_scan(151, 260, row_by_row);
    expect_same_grid(scan, through(folder, "a.ptx", scan));
  }
}

TEST(WriteScan, PcdKeepsGridPoseIntensityAndColour) {
  const ScanFolder folder;
  for (const bool row_by_row : {false, true}) {
    const Scan scan = full_scan(151, 260, row_by_row);
    expect_same_grid(scan, through(folder, "a.pcd", scan));
  }
}

TEST(WriteScan, SeveralScansInOnePtx) {
  const ScanFolder folder;
  Scan plain = full_scan(7, 5);
  plain.rgb.clear();
  plain.world_from_scan.reset();
  const auto file = folder.path("two.ptx");
  io::writer_for(file).write(file, source({full_scan(3, 4), plain}));
  const auto scans = read_scans(file);
  ASSERT_EQ(scans.size(), 2u);
  expect_same_grid(scans[0], full_scan(3, 4));
  expect_same_grid(scans[1], plain);
}

TEST(WriteScan, PlyKeepsReturnsExactly) {
  const ScanFolder folder;
  const Scan scan = full_scan(100, 30);
  const Scan read = through(folder, "a.ply", scan);
  expect_same_returns(scan, read, 0);
  EXPECT_FALSE(read.organised());
}

TEST(WriteScan, PtsKeepsReturnsAndWholeIntensities) {
  const ScanFolder folder;
  Scan scan = full_scan(100, 30);
  for (float& value : scan.intensity) value = std::floor(4095 * value) - 2048;
  const Scan read = through(folder, "a.pts", scan);
  expect_same_returns(scan, read, 0);
  for (std::size_t i = 0, at = 0; i < scan.points.size(); ++i)
    if (!std::isnan(scan.points[i][0])) {
      ASSERT_EQ(scan.intensity[i], read.intensity[at++]);
    }
}

TEST(WriteScan, XyzKeepsReturnsIntensitiesAndColours) {
  const ScanFolder folder;
  const Scan scan = full_scan(100, 30);
  const Scan read = through(folder, "a.xyz", scan);
  expect_same_returns(scan, read, 0);
  std::size_t at = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (!std::isnan(scan.points[i][0])) {
      ASSERT_EQ(scan.intensity[i], read.intensity[at]);
      ASSERT_EQ(scan.rgb[i], read.rgb[at++]);
    }
  EXPECT_EQ(at, read.points.size());
  EXPECT_TRUE(read.notes.empty()) << read.notes[0];
  EXPECT_TRUE(bytes_of(folder.path("a.xyz")).starts_with("//X Y Z Intensity R G B\n"));
}

TEST(WriteScan, LasKeepsReturnsToTheHundredthOfAMillimetre) {
  const ScanFolder folder;
  Scan scan = full_scan(100, 30);
  for (const std::string crs : {"", "EPSG:27700", "PROJCS[\"a grid\",UNIT[\"metre\",1]]"}) {
    scan.crs = crs;
    const Scan read = through(folder, "a.las", scan);
    expect_same_returns(scan, read, 0.5001e-5);
    EXPECT_EQ(read.crs, crs);
    EXPECT_TRUE(read.notes.empty()) << read.notes[0];
    // Written again, nothing moves any more.
    const Scan again = through(folder, "b.las", read);
    EXPECT_EQ(again.points, read.points);
    EXPECT_EQ(again.intensity, read.intensity);
  }
}

TEST(WriteScan, GeoreferencedCoordinatesKeepTheirDigits) {
  const ScanFolder folder;
  const auto pts = folder.write(
      "in.pts",
      "3\n637012.24 849028.31 431.66 5\n636896.333 849087.7005 446.39 6\n636784.74 849106.66 426.7101 7\n");
  const Scan scan = io::read_scan(pts, 0);
  ASSERT_FALSE(scan.origin.isZero());
  for (const char* name : {"a.ptx", "a.pts", "a.ply", "a.pcd", "a.xyz"}) {
    SCOPED_TRACE(name);
    const Scan read = through(folder, name, scan);
    EXPECT_EQ(read.origin, scan.origin);
    EXPECT_EQ(read.points, scan.points);
  }
  EXPECT_EQ(bytes_of(folder.path("a.pts")), bytes_of(pts));  // no more digits than there were
  const Scan las = through(folder, "a.las", scan);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((las.point(i) - scan.point(i)).norm(), 1e-5);
}

TEST(WriteScan, IntensitiesGoToTheRangeOfTheFormatAndBack) {
  const ScanFolder folder;
  Scan scan = full_scan(100, 30);
  for (auto& point : scan.points) point = {1, 2, 3};
  for (std::size_t i = 0; i < scan.intensity.size(); ++i) scan.intensity[i] = static_cast<float>(i * 20);
  const Scan las = through(folder, "a.las", scan);
  EXPECT_EQ(las.intensity, scan.intensity);
  const Scan ptx = through(folder, "a.ptx", las);
  EXPECT_EQ(ptx.intensity_limits, (std::array<float, 2>{0, 1}));
  EXPECT_EQ(through(folder, "b.las", ptx).intensity, las.intensity);
}

// PLY, PCD and EXR say no limits: fractions within the range of a format of whole numbers would become few.
TEST(WriteScan, IntensitiesWithoutLimitsKeepTheirStepsInFormatsOfWholeNumbers) {
  const ScanFolder folder;
  Scan scan = full_scan(100, 30);
  for (auto& point : scan.points) point = {1, 2, 3};
  scan.intensity_limits.reset();
  for (std::size_t i = 0; i < scan.intensity.size(); ++i)
    scan.intensity[i] = static_cast<float>(i) / static_cast<float>(scan.intensity.size());
  const Scan las = through(folder, "a.las", scan), pts = through(folder, "a.pts", scan);
  for (std::size_t i = 0; i < scan.intensity.size(); ++i) {
    EXPECT_NEAR(las.intensity[i], 65535 * scan.intensity[i], 0.51);
    EXPECT_NEAR(pts.intensity[i], 4095 * scan.intensity[i] - 2048, 0.51);
  }
  for (float& value : scan.intensity) value = 10 + 5 * value;
  EXPECT_NEAR(through(folder, "b.las", scan).intensity.back(), 65535, 1);
  for (float& value : scan.intensity) value = 1000 * (value - 10);
  EXPECT_NEAR(through(folder, "c.las", scan).intensity.back(), scan.intensity.back(), 0.51);
}

// What people write for one system, and what says none.
TEST(WriteScan, CoordinateSystemsByTheirCodesReachLas) {
  const ScanFolder folder;
  Scan scan = full_scan(4, 5);
  const auto dropped = [&](const char* name) {
    return fmt::format("{}", fmt::join(losses_in(name, scan).dropped, ", "));
  };
  for (const auto& [written, read] : {std::pair{"epsg:25832", "EPSG:25832"},
                                      {"25832", "EPSG:25832"},
                                      {"urn:ogc:def:crs:EPSG::4326", "EPSG:4326"},
                                      {"EPSG:25832+7837", "EPSG:25832+7837"}}) {
    scan.crs = written;
    EXPECT_EQ(through(folder, "a.las", scan).crs, read);
    EXPECT_FALSE(holds(dropped("a.las"), "coordinate system"));
  }
  for (const char* written : {"EPSG:0", "EPSG:nonsense", "EPSG:99999", "a grid"}) {
    scan.crs = written;
    EXPECT_EQ(through(folder, "b.las", scan).crs, "");
    EXPECT_TRUE(holds(dropped("b.las"), "no EPSG:n and no WKT"));
  }
}

TEST(WriteScan, LossesAreNamed) {
  const Scan scan = full_scan(4, 5);
  const auto losses = [&](const char* name, const Scan& of) {
    const auto found = losses_in(name, of);
    return fmt::format("{} | {}", fmt::join(found.dropped, ", "), fmt::join(found.changed, ", "));
  };
  EXPECT_EQ(losses("a.ptx", scan), " | ");
  EXPECT_EQ(losses("a.pcd", scan), " | ");
  EXPECT_TRUE(holds(losses("a.ply", scan), "grid (4 x 5), pose"));
  EXPECT_TRUE(holds(losses("a.pts", scan), "intensity rounded to whole numbers"));
  EXPECT_TRUE(holds(losses("a.las", scan), "coordinates rounded to steps of 1e-06 m, by up to 5e-07 m"));
  Scan scaled = scan;
  scaled.world_from_scan->scale = 2;
  scaled.crs = "EPSG:27700";
  EXPECT_EQ(losses("a.pcd", scaled), "the pose's scale (2), coordinate system | ");
}

// As a range image has them.
TEST(WriteScan, SamplesBesideTheGridAreNoPartOfIt) {
  const ScanFolder folder;
  const Scan grid = full_scan(4, 5, true);
  Scan scan = grid;
  scan.range_grid = RangeGrid{};
  scan.points.push_back({7, 8, 9});
  scan.intensity.push_back(0.5f);
  scan.rgb.push_back({1, 2, 3});
  for (const char* name : {"a.ptx", "a.pcd"}) {
    expect_same_grid(grid, through(folder, name, scan));
    EXPECT_EQ(losses_in(name, scan).dropped, (std::vector<std::string>{"angle tables, interpolated nodes (0)",
                                                                       "samples beside the grid (1)"}));
  }
  EXPECT_EQ(through(folder, "a.ply", scan).points.back(), (std::array<float, 3>{7, 8, 9}));
}

TEST(WriteScan, E57AndRangeImagesKeepEverySample) {
  const ScanFolder folder;
  for (const bool row_by_row : {false, true}) {
    Scan scan = full_scan(37, 29, row_by_row);
    scan.crs = "EPSG:27700";
    scan.intensity_limits = {0, 1};
    scan.points[5] = {0, 0, 0};  // at the mirror: no return
    for (const char* name : {"a.e57", "a.exr"}) {
      SCOPED_TRACE(name);
      EXPECT_TRUE(losses_in(name, scan).dropped.empty());
      EXPECT_TRUE(losses_in(name, scan).changed.empty());
      const Scan read = through(folder, name, scan);
      Scan expected = scan;
      expected.points[5] = {kNaN, kNaN, kNaN};
      expect_same_grid(expected, read);
      EXPECT_EQ(read.row_by_row, row_by_row);
      EXPECT_EQ(read.crs, "EPSG:27700");
      EXPECT_EQ(read.intensity_limits, scan.intensity_limits);
      std::filesystem::remove(folder.path(name));
    }
  }
}

TEST(WriteScan, E57AndRangeImagesKeepListsInTheirOrder) {
  const ScanFolder folder;
  Scan scan = full_scan(1, 3000);
  scan.grid_rows = scan.grid_cols = 0;
  scan.origin = {530'000, 180'000.25, 0};
  for (const char* name : {"b.e57", "b.exr"}) {
    const Scan read = through(folder, name, scan);
    EXPECT_FALSE(read.organised());
    ASSERT_EQ(read.points.size(), 3000u);
    EXPECT_TRUE(read.intensity == scan.intensity && read.rgb == scan.rgb);
    for (std::size_t i = 0; i < 3000; ++i) {
      ASSERT_EQ(std::isnan(read.points[i][0]), std::isnan(scan.points[i][0]));
      if (!std::isnan(scan.points[i][0])) {
        ASSERT_LT((read.point(i) - scan.point(i)).norm(), 1e-4);  // the origin is chosen anew
      }
    }
  }
  // One sample, and none.
  for (const std::size_t count : {1u, 0u}) {
    scan = full_scan(1, static_cast<int>(count));
    scan.grid_rows = scan.grid_cols = 0;
    for (const char* name : {"c.e57", "c.exr"})
      EXPECT_EQ(through(folder, name, scan).points.size(), count) << name;
  }
}

// As E57 files of scanners are: nodes without a sample have no record, and a node may have a second return.
TEST(WriteScan, AGridWithMissingNodesIsFilledWithNoReturns) {
  const ScanFolder folder;
  Scan scan = full_scan(3, 2);
  scan.intensity.resize(4);
  scan.points = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 1, 1}};
  scan.rgb.resize(4);
  scan.node = {5, 0, 2, Scan::kNoNode};  // row * 2 + column
  for (const char* name : {"a.ptx", "a.pcd", "a.e57", "a.exr"}) {
    const auto losses = losses_in(name, scan);
    EXPECT_EQ(losses.dropped, std::vector<std::string>{"samples beside the grid (1)"}) << name;
    const Scan read = through(folder, name, scan);
    if (!read.node.empty()) {  // these hold no more than the samples
      EXPECT_EQ(read.node, (std::vector<std::uint32_t>{5, 0, 2})) << name;
      EXPECT_EQ(read.points, std::vector(scan.points.begin(), scan.points.end() - 1));
      continue;
    }
    ASSERT_EQ(read.points.size(), 6u) << name;
    const auto at = [&](int row, int col) { return read.points[read.grid_index(row, col)]; };
    EXPECT_EQ(at(2, 1), scan.points[0]);
    EXPECT_EQ(at(0, 0), scan.points[1]);
    EXPECT_EQ(at(1, 0), scan.points[2]);
    EXPECT_FALSE(at(0, 1)[0] > 0);
    EXPECT_EQ(read.intensity[read.grid_index(2, 1)], scan.intensity[0]);
    EXPECT_EQ(read.rgb[read.grid_index(1, 0)], scan.rgb[2]);
  }
}

TEST(WriteScan, OtherExtensionsAreNamedWithThoseThereAre) {
  EXPECT_TRUE(holds(error_of(ErrorKind::usage, [] { io::writer_for("a.abc"); }),
                    ".ptx, .pts, .xyz, .ply, .pcd, .las, .e57, .exr, found .abc"));
}

TEST(WriteScan, NoReturnsAtAll) {
  const ScanFolder folder;
  Scan scan;
  scan.points.assign(6, {kNaN, kNaN, kNaN});
  for (const char* name : {"a.pts", "a.ply", "a.las", "a.xyz"})
    EXPECT_TRUE(through(folder, name, scan).points.empty()) << name;
  for (const char* name : {"a.ptx", "a.pcd"})
    EXPECT_EQ(through(folder, name, scan).points.size(), 6u) << name;
}

}  // namespace
}  // namespace hybrid::testing::write_scan_test
