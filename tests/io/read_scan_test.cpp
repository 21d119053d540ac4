// One scan of many, without the others.
#include "io/read_scan.hpp"

#include <gtest/gtest.h>

#include "io/allocation_watch.hpp"
#include "io/scan_files.hpp"
#include "io/scan_info.hpp"

namespace hybrid::testing {
namespace {

std::string ptx_scan(int cols, int rows, double first) {
  std::string text = fmt::format("{}\n{}\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n{} 0 0 1\n",
                                 cols, rows, first);
  for (int i = 0; i < cols * rows; ++i) text += fmt::format("{} 1 2 0.5\n", first + i);
  return text;
}

TEST(ReadScan, ListsWithoutReading) {
  const ScanFolder folder;
  std::string text;
  for (int k = 0; k < 50; ++k) text += ptx_scan(20 + k, 30, k);
  const auto file = folder.write("many.ptx", text);
  const AllocationWatch watch;
  const auto entries = io::list_scans(file);
  ASSERT_EQ(entries.size(), 50u);
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_EQ(entries[k].name, fmt::format("many-{}", k));
    EXPECT_EQ(entries[k].grid_cols, static_cast<int>(20 + k));
    EXPECT_EQ(entries[k].grid_rows, 30);
    EXPECT_EQ(entries[k].samples, 30 * (20 + k));
    EXPECT_EQ(entries[k].problem, "");
  }
  const Scan scan = io::read_scan(file, 37);
  EXPECT_EQ(scan.name, "many-37");
  EXPECT_EQ(scan.points.size(), 30u * 57);
  EXPECT_EQ(scan.points[0][0], 37);
  EXPECT_EQ(scan.points.back()[0], 37 + 30 * 57 - 1);
  EXPECT_EQ(scan.world_from_scan->translation.x(), 37);
  EXPECT_LT(watch.largest_bytes(), 8u << 20);
}

TEST(ReadScan, AnIndexBeyondTheLastIsNamed) {
  const ScanFolder folder;
  const auto file = folder.write("a.ptx", ptx_scan(2, 2, 1) + ptx_scan(2, 2, 1));
  expect_input_error([&] { io::read_scan(file, 2); }, {file.string(), "index 2", "holds 2 scans"});
}

// What is damaged does not take the others with it.
TEST(ReadScan, ADamagedScanLeavesThoseBeforeIt) {
  const ScanFolder folder;
  const std::string good = ptx_scan(2, 3, 1);
  const auto cut = folder.write("cut.ptx", good + good + good.substr(0, good.size() - 12));
  auto entries = io::list_scans(cut);
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(io::read_scan(cut, entries[1]).points.size(), 6u);
  expect_input_error([&] { io::read_scan(cut, entries[2]); },
                     {cut.string(), "line 48", "of which 5 are here"});

  std::string bytes = good + good;
  const auto spoilt = folder.write("spoilt.ptx", bytes.replace(good.rfind("0.5\n"), 3, "x.5"));
  entries = io::list_scans(spoilt);
  ASSERT_EQ(entries.size(), 2u);
  expect_input_error([&] { io::read_scan(spoilt, entries[0]); }, {spoilt.string(), "line 16", "\"x.5\""});
  EXPECT_EQ(io::read_scan(spoilt, entries[1]).points.size(), 6u);

  const auto infos = io::read_scan_info(spoilt);
  ASSERT_EQ(infos.size(), 2u);
  EXPECT_TRUE(holds(infos[0].problem, "line 16"));
  EXPECT_EQ(infos[0].points, 6u);
  EXPECT_EQ(infos[1].problem, "");
  EXPECT_EQ(infos[1].returns, 6u);
  EXPECT_EQ(infos[1].structure, "x y z intensity");
}

TEST(ReadScan, FirstBytesTellWhatAFileIs) {
  const ScanFolder folder;
  const auto list = [](const std::filesystem::path& file) { return [=] { io::list_scans(file); }; };
  const auto las = folder.write("a.ptx", "LASF and more");
  expect_input_error(list(las),
                     {las.string(), "expected a .ptx file", "of a .las file; correct its extension"});
  expect_input_error(list(folder.write("a.laz", "LASF and more")), {"found .laz", "decompress it first"});
  const auto zip = folder.write("a.e57", std::string("PK\x03\x04zip"));
  expect_input_error(list(zip), {"expected a .e57 file", "of a .zip file; it is packed: unpack it first"});
  const auto nameless = folder.write("nameless", "ASTM-E57 and more");
  expect_input_error(list(nameless), {"found no extension", "those of a .e57 file: name it so"});
}

TEST(ReadScan, OtherFormatsHaveAdvice) {
  const ScanFolder folder;
  const std::pair<const char*, const char*> advice[] = {
      {"a.fls", "export E57 from SCENE"},   {"a.ZFS", "LaserControl"},        {"a.rdbx", "RiSCAN"},

      {"a.obj", "[model] in a scene file"}, {"a.laz", "decompress it first"}, {"a.png", "with intrinsics"},
      {"a.dwg", "export it as OBJ"},        {"a.jpg", "[photographs]"},       {"a.toml", "hybrid run SCENE"},
      {"a.what", "correct its extension"}};
  for (const auto& [name, what] : advice) {
    const auto file = folder.write(name, "something");
    expect_input_error([&] { io::list_scans(file); }, {file.string(), "expected a scan as .e57", what});
  }
}

}  // namespace
}  // namespace hybrid::testing
