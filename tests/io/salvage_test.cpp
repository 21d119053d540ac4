// What --salvage makes of damaged text and binary scans: the good part, and how much is lost where. Each file
// is refused without it, by an error that names place and remedy.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/vectors.hpp"
#include "io/las_samples.hpp"
#include "io/read_scan.hpp"
#include "io/reader_table.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::salvage_test {
namespace {

// What becomes of a damaged file.
struct Case {
  std::string name;  // of the damage
  std::string file, bytes;
  std::vector<std::string> error;  // without salvage
  std::vector<int> points;         // of scan_samples.hpp; -1: a no-return
  std::vector<std::string> notes;
  int rows = 0, cols = 0;  // of the grid, where there is one
  bool colours_lost = false;
};

class Salvage : public ::testing::Test {
 protected:
  void expect(const Case& c) const {
    SCOPED_TRACE(c.file + ", " + c.name);
    const auto file = folder_.write(c.file, c.bytes);
    std::vector<std::string> error = c.error;
    error.push_back(file.string() + ": ");
    error.emplace_back("use --salvage");
    expect_input_error([&] { read(file, false); }, error);
    const std::vector<Scan> scans = read(file, true);
    ASSERT_EQ(scans.size(), 1u);
    const Scan& scan = scans[0];
    ASSERT_EQ(scan.points.size(), c.points.size());
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const float expected = c.points[i] < 0 ? kNaN : kSamplePoints[c.points[i]][k];
        if (std::isnan(expected))
          EXPECT_TRUE(std::isnan(scan.points[i][k])) << i;
        else
          EXPECT_EQ(scan.points[i][k], expected) << i;
      }
    for (std::size_t i = 0; i < scan.rgb.size() && !c.colours_lost; ++i)
      for (std::size_t k = 0; k < 3 && c.points[i] >= 0; ++k)
        EXPECT_EQ(scan.rgb[i][k], kSampleRgb[c.points[i]][k]);
    std::string notes;
    for (const std::string& note : scan.notes) notes += note + "\n";
    for (const std::string& part : c.notes) EXPECT_TRUE(holds(notes, part));
    if (c.rows > 0) {
      EXPECT_EQ(scan.grid_rows, c.rows);
      EXPECT_EQ(scan.grid_cols, c.cols);
    }
  }
  static std::vector<Scan> read(const std::filesystem::path& file, bool salvage) {
    std::vector<Scan> scans;
    for (const io::ScanEntry& entry : io::list_scans(file, {.salvage = salvage}))
      scans.push_back(io::read_scan(file, entry));
    return scans;
  }
  static std::string changed(const std::string& bytes, const std::string& from, const std::string& to) {
    return edited(bytes, {from, to});
  }

  ScanFolder folder_;
};

TEST_F(Salvage, Ptx) {
  const std::string good = sample_file("ptx", "");
  const std::size_t third = good.find("-3 0 1");
  expect({"cut behind three points",
          "a.ptx",
          good.substr(0, good.find("0.125")),
          {"line 14", "found the end"},
          {0, 1, 2, -1},
          {"1 of 4 points (25.00 %) are lost", "byte "},
          2,
          2});
  expect({"cut behind two",
          "a.ptx",
          good.substr(0, third),
          {"the end of the file"},
          {0, 1},
          {"2 of 4 points (50.00 %) are lost", fmt::format("byte {}", third)},
          2,
          1});
  expect({"a line that is none",
          "a.ptx",
          changed(good, "0 2 -0.5", "0 \x01\xff -0.5"),
          {"line 12", "number"},
          {0, -1, 2, 3},
          {"1 of 4 points (25.00 %) are lost", "line 12"},
          2,
          2});
  expect({"a line cut short",
          "a.ptx",
          changed(good, "0 2 -0.5", "-0.5"),
          {"line 12", "found 5"},
          {0, -1, 2, 3},
          {"line 12"},
          2,
          2});
  expect({"a count too high",
          "a.ptx",
          changed(good, "2\n2\n", "9\n2\n"),
          {"line 1"},
          {0, 1, 2, 3},
          {"14 of 18 points (77.78 %) are lost"},
          2,
          2});
  expect({"a count beyond memory",
          "a.ptx",
          changed(good, "2\n2\n", "2000000000\n2\n"),
          {"line 1", "room for"},
          {0, 1, 2, 3},
          {"3999999996 of 4000000000 points"},
          2,
          2});
  expect({"absurd coordinates",
          "a.ptx",
          changed(good, "0 2 -0.5", "0 2 1e30"),
          {"point 1", "1000000000000 m"},
          {0, -1, 2, 3},
          {"1 of 4 points have absurd coordinates (point 1"},
          2,
          2});
  expect({"a matrix that is none",
          "a.ptx",
          changed(good, "5 6 7 1\n", "5 nan 7 1\n"),
          {"lines 7 to 10"},
          {0, 1, 2, 3},
          {"lines 7 to 10", "the pose is left out"},
          2,
          2});
}

// Of three scans the middle one is damaged, in its header or by its count: the others go on.
TEST_F(Salvage, PtxOtherScansGoOn) {
  const std::string good = sample_file("ptx", "");
  const auto file = folder_.write("three.ptx", good + changed(good, "2\n2\n", "7\n2\n") + good);
  auto entries = io::list_scans(file, {.salvage = true});
  ASSERT_EQ(entries.size(), 3u);
  for (const auto& entry : entries) EXPECT_EQ(io::read_scan(file, entry).points.size(), 4u);
  const auto fewer = folder_.write("fewer.ptx", good + changed(good, "2\n2\n", "1\n2\n") + good);
  entries = io::list_scans(fewer, {.salvage = true});
  ASSERT_EQ(entries.size(), 4u);
  EXPECT_EQ(io::read_scan(fewer, entries[1]).points.size(), 2u);
  EXPECT_TRUE(holds(entries[2].problem, "line 27: expected a scan's columns, rows and position"));
  EXPECT_TRUE(holds(entries[2].problem, "bytes ("));
  EXPECT_EQ(io::read_scan(fewer, entries[3]).points.size(), 4u);
  const auto broken = folder_.write("broken.ptx", good + changed(good, "2\n2\n", "2\ntwo\n") + good);
  entries = io::list_scans(broken, {.salvage = true});
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_FALSE(entries[1].problem.empty());
  EXPECT_EQ(io::read_scan(broken, entries[2]).points.size(), 4u);
}

TEST_F(Salvage, Pts) {
  const std::string good = sample_file("pts", "");
  expect({"cut behind three points",
          "a.pts",
          good.substr(0, good.find("0.125")),
          {"line 5", "expected 4 points"},
          {0, 1, 2},
          {"1 of 4 points (25.00 %) are lost", "byte "}});
  expect({"a count too low",
          "a.pts",
          changed(good, "4\n1.5", "3\n1.5"),
          {"line 5", "found 7 numbers"},
          {0, 1, 2, 3},
          {"expected 3 points as the line before says, found 4: all are used"}});
  expect({"a count beyond memory",
          "a.pts",
          changed(good, "4\n1.5", "4000000000\n1.5"),
          {"line 1", "room for"},
          {0, 1, 2, 3},
          {"3999999996 of 4000000000 points (100.00 %) are lost"}});
  expect({"a line that is none",
          "a.pts",
          changed(good, "0 2 -0.5", "0 \x01 -0.5"),
          {"line 3"},
          {0, -1, 2, 3},
          {"1 of 4 points (25.00 %) are lost", "line 3"}});
  expect({"absurd coordinates",
          "a.pts",
          changed(good, "0 2 -0.5", "0 2e13 -0.5"),
          {"point 1"},
          {0, -1, 2, 3},
          {"absurd coordinates"}});
}

TEST_F(Salvage, Ply) {
  const std::string text = sample_file("ply", "ascii"), binary = sample_file("ply", "binary_little_endian");
  expect({"cut",
          "a.ply",
          text.substr(0, text.find("0.125")),
          {"line 15", "expected 4 records"},
          {0, 1, 2},
          {"1 of 4 points (25.00 %) are lost"}});
  expect({"a count beyond memory",
          "a.ply",
          changed(text, "vertex 4", "vertex 4000000000"),
          {"line 3"},
          {0, 1, 2, 3},
          {"3999999996 of 4000000000 points"}});
  expect({"a count too low",
          "a.ply",
          changed(text, "vertex 4", "vertex 3"),
          {"found another vertex"},
          {0, 1, 2},
          {"line 15", "after the last record are ignored"}});
  expect({"a line that is none",
          "a.ply",
          changed(text, "0 2 -0.5", "0 2 --"),
          {"line 13"},
          {0, -1, 2, 3},
          {"line 13"}});
  expect({"cut",
          "b.ply",
          binary.substr(0, binary.size() - 3),
          {"room for 3"},
          {0, 1, 2},
          {"1 of 4 points (25.00 %) are lost", "byte "}});
  expect({"a count beyond memory",
          "b.ply",
          changed(binary, "vertex 4", "vertex 18000000000000000000"),
          {"line 3"},
          {0, 1, 2, 3},
          {"of 18000000000000000000 points"}});
  expect({"a count too low",
          "b.ply",
          changed(binary, "vertex 4", "vertex 3"),
          {"room for 1 vertices"},
          {0, 1, 2},
          {"19 bytes after the last record are ignored"}});
  expect({"absurd coordinates",
          "b.ply",
          changed(binary, raw(-0.5f), raw(-5e20f)),
          {"point 1"},
          {0, -1, 2, 3},
          {"absurd coordinates"}});
}

TEST_F(Salvage, PlyWhoseListsLie) {
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty list uint float echo\nend_header\n";
  const std::string point = raw(1.5f) + raw(0.0f) + raw(0.25f);
  expect({"a list beyond the end",
          "a.ply",
          head + point + raw(std::uint32_t{1}) + raw(0.0f) + point + raw(~0u),
          {"expected 4294967295 values"},
          {0},
          {"1 of 2 points (50.00 %) are lost", "expected 4294967295 values"}});
}

TEST_F(Salvage, Pcd) {
  const auto grid = [&](const std::string& kind) {
    return changed(sample_file("pcd", kind), "WIDTH 4\nHEIGHT 1", "WIDTH 2\nHEIGHT 2");
  };
  const std::string text = grid("ascii"), binary = grid("binary"), packed = grid("binary_compressed");
  expect({"cut",
          "a.pcd",
          text.substr(0, text.find("0.125")),
          {"expected 4 points"},
          {0, 1, 2, -1},
          {"1 of 4 points (25.00 %) are lost"},
          2,
          2});
  expect({"a line that is none",
          "a.pcd",
          changed(text, "0 2 -0.5", "0 -0.5"),
          {"line 13"},
          {0, -1, 2, 3},
          {"line 13"},
          2,
          2});
  expect({"a count too low",
          "a.pcd",
          changed(text, "HEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4",
                  "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2"),
          {"found another point"},
          {0, 1},
          {"after the last point are ignored"}});
  expect({"counts that differ",
          "a.pcd",
          changed(text, "POINTS 4", "POINTS 3"),
          {"expected POINTS"},
          {0, 1, 2},
          {"expected POINTS to be WIDTH x HEIGHT", "after the last point are ignored"}});
  expect({"cut",
          "b.pcd",
          binary.substr(0, binary.size() - 21),
          {"room for 2"},
          {0, 1},
          {"2 of 4 points (50.00 %) are lost", "byte "}});
  expect({"a count beyond memory",
          "b.pcd",
          changed(binary, "WIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4",
                  "WIDTH 2\nHEIGHT 2000000000\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4000000000"),
          {"room for 4"},
          {0, 1, 2, 3},
          {"3999999996 of 4000000000 points"},
          2,
          2});
  expect({"absurd coordinates",
          "b.pcd",
          changed(binary, raw(-0.5f), raw(3e38f)),
          {"point 1"},
          {0, -1, 2, 3},
          {"absurd coordinates"},
          2,
          2});
  expect({"no pose",
          "b.pcd",
          changed(binary, "VIEWPOINT 0 0 0 1", "VIEWPOINT 0 0 0 7"),
          {"unit quaternion"},
          {0, 1, 2, 3},
          {"unit quaternion"},
          2,
          2});
  // Cut within the last field, the colours: all points are there.
  const std::string cut = packed.substr(0, packed.size() - 10);
  const auto file = folder_.write("c.pcd", cut);
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read(file, false); }), "use --salvage"));
  const Scan scan = read(file, true).at(0);
  EXPECT_EQ(scan.points[3], (std::array{kSamplePoints[3][0], kSamplePoints[3][1], kSamplePoints[3][2]}));
  EXPECT_EQ(scan.intensity, std::vector<float>(std::begin(kSampleIntensity), std::end(kSampleIntensity)));
  EXPECT_TRUE(holds(fmt::format("{}", fmt::join(scan.notes, "\n")), "cut off and 0 from some point on: rgb"));
  // Cut within z: a literal run of 32 bytes, then x and y and half of z.
  const std::size_t data = packed.find("binary_compressed\n") + 18 + 8;
  std::string half = packed.substr(0, data + 33) + '\7' + packed.substr(data + 34, 8);
  expect({"cut within z",
          "d.pcd",
          half,
          {"compressed bytes"},
          {0, 1},
          {"2 of 4 points (50.00 %) are lost", "cut off and 0 from some point on: intensity rgb"},
          0,
          0,
          true});
}

TEST_F(Salvage, Las) {
  for (const int minor : {2, 4}) {
    const std::string good = las_sample(minor);
    const std::string count = minor == 4
                                  ? raw(std::uint32_t{0}) + raw(std::uint64_t{4}) + raw(std::uint64_t{4})
                                  : raw(std::uint32_t{4}) + raw(std::uint32_t{4});
    const auto counted = [&](std::uint32_t points) {
      return changed(good, count,
                     minor == 4 ? raw(std::uint32_t{0}) + raw(std::uint64_t{points}) + raw(std::uint64_t{4})
                                : raw(points) + raw(std::uint32_t{4}));
    };
    expect({"cut",
            "a.las",
            good.substr(0, good.size() - 5),
            {"room for 3"},
            {0, 1, 2},
            {"1 of 4 points (25.00 %) are lost", "byte "}});
    expect({"a count beyond memory",
            "a.las",
            counted(4'000'000'000),
            {"room for 4"},
            {0, 1, 2, 3},
            {"3999999996 of 4000000000 points"}});
    expect({"a count too low",
            "a.las",
            counted(3),
            {"more bytes"},
            {0, 1, 2},
            {"after the last point are ignored"}});
    const std::size_t record = good.find("LASF_Projection") + 18;
    std::string lies = good;
    lies.replace(record, 2, "\xff\xff");
    expect({"a record that lies",
            "a.las",
            lies,
            {"variable length record 1"},
            {0, 1, 2, 3},
            {"what follows it is lost"}});
  }
}

}  // namespace
}  // namespace hybrid::testing::salvage_test
