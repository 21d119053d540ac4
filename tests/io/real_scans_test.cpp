#include <gtest/gtest.h>

#include <cstdlib>

#include "io/read_scan.hpp"
#include "io/scan_files.hpp"
#include "io/scan_info.hpp"

namespace hybrid::testing {
namespace {

std::filesystem::path data_folder() {
  const char* given = std::getenv("HYBRID_DATA");
  return given ? std::filesystem::path(given) : std::filesystem::path(HYBRID_PROJECT_DIR) / "../shared/data";
}

// What each file gives: its scans' points, returns and grid, or what the error says.
struct RealScan {
  const char* file;
  std::size_t scans;
  std::uint64_t points, returns;  // of the last scan
  int rows, cols;
  bool intensity, colour, pose, far;  // far: an origin of its own
  const char* text;                   // in the error (scans = 0), or in a note of the last scan ("": no note)
};

const RealScan kRealScans[] = {
    {"scans/pcl-room/room_scan1.pcd", 1, 112586, 112586, 0, 0, false, false, false, false, ""},
    {"scans/pcl-room/room_scan2.pcd", 1, 112624, 112624, 0, 0, false, false, false, false, ""},
    {"planes/synpeb/test_100.pcd", 1, 10000, 10000, 100, 100, true, false, false, false, ""},
    {"planes/synpeb/cottage_01_head.ptx", 1, 4340, 4340, 868, 5, true, true, true, false, ""},
    {"formats/pdal/ptx/1.2-with-color.ptx", 1, 1065, 1065, 71, 15, true, true, false, true, "large"},
    {"formats/pdal/ptx/complex-transform.ptx", 1, 12, 4, 6, 2, true, true, true, false, ""},
    {"formats/pdal/ptx/multiple-and-transform.ptx", 0, 0, 0, 0, 0, false, false, false, false,
     "lines 7 to 10 (the scan's 4x4 matrix): pose: the upper left 3x3 is not a rotation times a scale"},
    {"formats/pdal/ptx/no-color.ptx", 1, 15, 15, 0, 0, true, false, false, true, "large"},
    {"formats/pdal/pcd/autzen-utm.pcd", 1, 1065, 1065, 0, 0, true, true, false, true, "returnnumber"},
    {"formats/pdal/pcd/utm17_space.pcd", 1, 10, 10, 0, 0, false, false, false, true, "large"},
    {"formats/pdal/pcd/utm17_tab.pcd", 1, 10, 10, 0, 0, false, false, false, true, "large"},
    {"formats/pdal/pcd/utm17_comma.pcd", 1, 10, 10, 0, 0, false, false, false, true, "commas"},
    {"formats/pdal/pcd/missingheader.pcd", 0, 0, 0, 0, 0, false, false, false, false,
     "line 1: expected a PCD header keyword (VERSION, FIELDS, SIZE, ..., DATA), found \"289814.15\""},
    {"formats/pdal/ply/simple_binary.ply", 1, 3, 3, 0, 0, false, false, false, false, ""},
    {"formats/pdal/ply/simple_text.ply", 1, 3, 3, 0, 0, false, false, false, false, ""},
    {"formats/pdal/ply/mesh.ply", 1, 4, 4, 0, 0, false, false, false, false, "elements not used: 2 face"},
    {"formats/pdal/ply/mesh_fixed.ply", 1, 4, 4, 0, 0, false, false, false, false,
     "elements not used: 2 face"},
    {"formats/pdal/ply/text_extradim.ply", 1, 1, 1, 0, 0, false, true, false, false, "nx ny nz alpha omg"},
    {"formats/pdal/ply/issue_2421.ply", 1, 1, 1, 0, 0, false, false, false, true, "properties not used: i"},
    {"formats/pdal/ply/sized_dims.ply", 0, 0, 0, 0, 0, false, false, false, false,
     "line 4: expected properties x, y and z in element vertex, found no z"},
    {"formats/pdal/ply/unsized_dims.ply", 0, 0, 0, 0, 0, false, false, false, false, "found no z"},
    {"formats/pdal/ply/no_vertex.ply", 0, 0, 0, 0, 0, false, false, false, false,
     "line 3: expected an element named vertex"},
};

void PrintTo(const RealScan& scan, std::ostream* out) {
  *out << scan.file;
}

class RealScans : public ::testing::TestWithParam<RealScan> {};

TEST_P(RealScans, GivesWhatIsKnownOfIt) {
  const RealScan& expected = GetParam();
  const auto file = data_folder() / expected.file;
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs " << expected.file << " under ../shared/data or HYBRID_DATA";
  if (expected.scans == 0) {
    expect_input_error([&] { io::read_scans(file); }, {file.string() + ": ", expected.text});
    return;
  }
  const auto scans = io::read_scans(file);
  ASSERT_EQ(scans.size(), expected.scans);
  const Scan& scan = scans.back();
  const io::ScanInfo info = io::describe(scan, "");
  EXPECT_EQ(info.points, expected.points);
  EXPECT_EQ(info.returns, expected.returns);
  EXPECT_EQ(info.grid_rows, expected.rows);
  EXPECT_EQ(info.grid_cols, expected.cols);
  EXPECT_EQ(info.has_intensity, expected.intensity);
  EXPECT_EQ(info.has_colour, expected.colour);
  EXPECT_EQ(info.world_from_scan.has_value(), expected.pose);
  EXPECT_EQ(!scan.origin.isZero(), expected.far);
  const std::string notes = fmt::format("{}", fmt::join(scan.notes, "; "));
  if (*expected.text) {
    EXPECT_NE(notes.find(expected.text), std::string::npos) << notes;
  } else {
    EXPECT_EQ(notes, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Files, RealScans, ::testing::ValuesIn(kRealScans), [](const auto& test) {
  std::string name = std::filesystem::path(test.param.file).filename().string();
  for (char& c : name)
    if (!isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

// The scanner of the rooms stands at the origin, in a hall of 29 x 14 x 3 m.
TEST(RealScansInDetail, RoomExtents) {
  const auto file = data_folder() / "scans/pcl-room/room_scan1.pcd";
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs scans/pcl-room under ../shared/data or HYBRID_DATA";
  const io::ScanInfo info = io::read_scan_info(file).at(0);
  const Vec3 extent = info.max_m - info.min_m;
  EXPECT_NEAR(extent.x(), 29, 1);
  EXPECT_NEAR(extent.y(), 14, 1);
  EXPECT_NEAR(extent.z(), 3, 0.5);
}

// An organised scan of flat walls: neighbours on the grid must be neighbours in space, along both directions.
TEST(RealScansInDetail, GridNeighboursAreClose) {
  const auto file = data_folder() / "planes/synpeb/test_100.pcd";
  if (!std::filesystem::exists(file))
    GTEST_SKIP() << "needs planes/synpeb under ../shared/data or HYBRID_DATA";
  const Scan scan = io::read_scans(file).at(0);
  const auto direction = [&](int row, int col) {
    const auto& p = scan.points[static_cast<std::size_t>(col * scan.grid_rows + row)];
    return Vec3(Vec3(p[0], p[1], p[2]).normalized());
  };
  for (int i = 0; i + 1 < 100; ++i) {
    EXPECT_LT((direction(i + 1, 50) - direction(i, 50)).norm(), 0.05);
    EXPECT_LT((direction(50, i + 1) - direction(50, i)).norm(), 0.05);
  }
}

}  // namespace
}  // namespace hybrid::testing
