// A scan in blocks is the scan read at once, in whatever order its samples are asked for.
#include "io/scan_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "core/scratch_file.hpp"
#include "io/allocation_watch.hpp"
#include "io/e57_grids.hpp"
#include "io/files.hpp"
#include "io/las_samples.hpp"
#include "io/read_scan.hpp"
#include "io/same_in_blocks.hpp"
#include "io/samples/sample_file.hpp"
#include "io/scan_samples.hpp"
#include "io/stream_scan.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {
using testing::all_nodes;
using testing::e57_of;
using testing::error_of;
using testing::expect_same;
using testing::TemporaryFolder;
namespace fs = std::filesystem;

std::string number(std::mt19937& random) {
  return fmt::format("{:.5f}", static_cast<double>(random() % 2'000'001) / 1e4 - 100);
}

// Rows of a text: no-returns, blank lines, lines longer than a piece's overlap.
std::string text_points(std::size_t count, int columns, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    const bool none = random() % 7 == 0;
    for (int k = 0; k < 3; ++k) text += (none ? "0" : number(random)) + ' ';
    if (columns % 3 == 1) text += fmt::format("{:.3f} ", static_cast<double>(random() % 1000) / 1000);
    for (int k = 0; k < 3 && columns >= 6; ++k) text += fmt::format("{} ", random() % 256);
    if (random() % 30'000 == 0) text += std::string(9000, ' ');
    text.back() = '\n';
    if (random() % 5000 == 0) text += "\n";
  }
  return text;
}

std::string ptx_header(int cols, int rows) {
  return fmt::format("{}\n{}\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n", cols, rows);
}

}  // namespace

TEST(ScanStream, TextIsTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr int kCols = 613, kRows = 500;  // more than two blocks
  static_assert(kCols * kRows > 2 * static_cast<int>(ScanStream::kBlock));
  for (const int columns : {4, 7})
    expect_same(folder.write("a.ptx", ptx_header(kCols, kRows) + text_points(kCols * kRows, columns, 1) +
                                          ptx_header(3, 2) + text_points(6, columns, 2)));
  for (const int columns : {3, 4, 6, 7})
    expect_same(
        folder.write("a.pts", fmt::format("{}\n", 150'000) + text_points(150'000, columns, 3) + "0\n"));
}

TEST(ScanStream, TextWithEverythingOddIsTheSameInBlocks) {
  const TemporaryFolder folder;
  expect_same(folder.write("far.pts", "3\n530000.123456 180000.5 3\n0 0 0\n530001 180001 3\n"));
  expect_same(folder.write("commas.pts", "2\n1,2,3,4\n5,6,7,-2000\n"));
  expect_same(folder.write("nan.pts", "3\nnan 1 2\n1e300 1 2\n1 2 3\n"));
  expect_same(folder.write("none.ptx", ptx_header(2, 2) + "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n"));
  expect_same(folder.write("one.pts", "1.5 2 3 0.25\n"));
}

TEST(ScanStream, TextsOfNamedColumnsAreTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr std::size_t kCount = ScanStream::kBlock + 9000;
  expect_same(folder.write("a.xyz", text_points(kCount, 7, 8)));
  expect_same(folder.write("b.csv", "b g r i x y z\n" + text_points(kCount, 7, 9)));
  expect_same(folder.write("c.txt", "x y z r g b\n1 2 3 0 0.5 1\n4 5 6 0.25 1 0\n"));
}

TEST(ScanStream, LasIsTheSameInBlocks) {
  const TemporaryFolder folder;
  for (const int minor : {2, 4}) expect_same(folder.write("a.las", testing::las_sample(minor)));
  std::string bytes = testing::las_sample(2);  // colours that are bytes
  for (std::size_t record = bytes.size() - 4 * 26; record < bytes.size(); record += 26)
    for (const std::size_t high : {21u, 23u, 25u}) bytes[record + high] = '\0';
  expect_same(folder.write("bytes.las", bytes));
  const auto cut = expect_same(folder.write("cut.las", bytes.substr(0, bytes.size() - 30)), true, true);
  EXPECT_EQ(cut->count(), 2u);  // of four records one is gone and one is cut
  const fs::path made = folder.path() / "made.las";
  for (const std::string first : {"", "530000.123456 180000.5 3 0 9 9 9\n"}) {
    const std::size_t count = first.empty() ? 300'000 : 20;
    const fs::path text = folder.write("a.pts", first + text_points(count, 7, 7));
    auto stream = stream_scan(text, list_scans(text, {.exact = true}).at(0));
    write_las(made, [&] { return std::move(stream); });
    expect_same(made);
  }
}

namespace {

// Vertices of `count` rows of text_points(count, 7): x y z intensity red green blue.
std::string ply_header(const std::string& format, std::size_t count, const std::string& coordinate,
                       const std::string& colour) {
  std::string text = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", format, count);
  for (const char* name : {"x", "y", "z"}) text += fmt::format("property {} {}\n", coordinate, name);
  text += "property float intensity\n";
  for (const char* name : {"red", "green", "blue"}) text += fmt::format("property {} {}\n", colour, name);
  return text + "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
}

// The same in binary: coordinates and colours as words.
const std::vector<std::size_t> kWords{8, 8, 8, 4, 2, 2, 2};  // bytes
std::string word_records(std::size_t count, bool big_endian) {
  std::mt19937 random(9);
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k)
      bytes += testing::raw(static_cast<double>(random() % 100'000) / 777 + 5000, big_endian);
    bytes += testing::raw(static_cast<float>(random() % 100), big_endian);
    for (int k = 0; k < 3; ++k) bytes += testing::raw(static_cast<std::uint16_t>(random()), big_endian);
  }
  return bytes;
}

std::string pcd_header(std::size_t width, std::size_t height, const std::string& data) {
  return fmt::format(
      "FIELDS x y z intensity red green blue\nSIZE 8 8 8 4 2 2 2\nTYPE F F F F U U U\nWIDTH {}\nHEIGHT {}\n"
      "VIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS {}\nDATA {}\n",
      width, height, width * height, data);
}

// What is compressed is read in blocks where there is room to lay it down.
bool scratch_has_room() {
  return ScratchFile::make(100 << 20) != nullptr;
}

// A sample file of `rows` x `cols` nodes with samples beside them.
void write_samples(const fs::path& file, int rows, int cols) {
  RangeImage image = make_range_image(rows, cols);
  for (std::size_t i = 0; i < image.elevation_rad.size(); ++i)
    image.elevation_rad[i] = 0.5 - 0.001 * static_cast<double>(i);
  for (std::size_t i = 0; i < image.azimuth_rad.size(); ++i)
    image.azimuth_rad[i] = 0.002 * static_cast<double>(i);
  image.intensity.assign(image.count(), 0);
  image.rgb.assign(image.count(), {});
  std::mt19937 random(8);
  for (std::size_t i = 0; i < image.count(); ++i) {
    image.mask[i] = random() % 5 != 0;
    image.x[i] = 2 + static_cast<float>(random() % 1000) / 512;
    image.y[i] = image.z[i] = 0.5f;
    image.intensity[i] = static_cast<float>(random() % 256) / 256;
    image.rgb[i] = {static_cast<std::uint8_t>(random()), 2, 3};
  }
  const std::vector<std::uint32_t> label(image.count());
  const std::vector<std::uint8_t> discarded(image.count());
  const std::vector<Supercluster> planes;
  SampleFileInput input{image, planes, label, discarded};
  input.extra = {{1, 2, 3}, {4, 5, 6}};
  input.extra_intensity = {0.5f, 0.25f};
  input.extra_rgb = {{1, 2, 3}, {4, 5, 6}};
  input.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), {1, 2, 3}};
  write_sample_file(file, input);
}

}  // namespace

TEST(ScanStream, PlyIsTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr std::size_t kCount = ScanStream::kBlock + 9000;
  const std::string faces = "3 0 1 2\n4 0 1 2 3\n", rows = text_points(kCount, 7, 11);
  for (const auto& [coordinate, colour] :
       {std::pair{"float", "uchar"}, {"double", "ushort"}, {"double", "float"}})
    expect_same(folder.write("a.ply", ply_header("ascii", kCount, coordinate, colour) + rows + faces));
  expect_same(folder.write("rest.ply", ply_header("ascii", 3, "float", "uchar") +
                                           "1,2,3,4,5,6,7\n\n1 2 3 4 5 6 nan\nnan 2 3 4 5 6 7\n" + faces +
                                           "more\n"));
  for (const bool big : {false, true}) {
    const std::string header =
        ply_header(big ? "binary_big_endian" : "binary_little_endian", kCount, "double", "ushort");
    std::string bytes = word_records(kCount, big) + '\1' + testing::raw(7, big) + '\0';
    expect_same(folder.write("words.ply", header + bytes));
    expect_same(folder.write("rest.ply", header + bytes + "more"));
  }
  expect_same(folder.write("none.ply", ply_header("ascii", 0, "float", "uchar") + faces));
}

namespace {

// Vertices: a list of up to three numbers, x y z as doubles, red green blue as words, another list.
std::string ply_with_lists(const std::string& format, std::size_t count) {
  std::string text =
      fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty list uchar int seen_by\n", format, count);
  for (const char* name : {"x", "y", "z"}) text += fmt::format("property double {}\n", name);
  for (const char* name : {"red", "green", "blue"}) text += fmt::format("property ushort {}\n", name);
  text +=
      "property list uchar float more\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const bool ascii = format == "ascii", big = format == "binary_big_endian";
  std::mt19937 random(13);
  const auto add = [&](auto value) {
    if (!ascii)
      text += testing::raw(value, big);
    else
      text += fmt::format("{} ", value);
  };
  const auto add_list = [&](auto value) {
    const auto length = static_cast<std::uint8_t>(random() % 4);
    add(length);
    for (int i = 0; i < length; ++i) add(value);
  };
  for (std::size_t i = 0; i < count; ++i) {
    add_list(std::int32_t{7});
    for (int k = 0; k < 3; ++k) add(static_cast<double>(random() % 100'000) / 777);
    for (int k = 0; k < 3; ++k) add(static_cast<std::uint16_t>(random() % 60'000));
    add_list(0.5f);
    if (ascii) text.back() = '\n';
    if (ascii && random() % 1000 == 0) text += "\n";
  }
  add(std::uint8_t{1});
  add(std::int32_t{0});
  return text;
}

}  // namespace

TEST(ScanStream, PlyWithListsIsTheSameInBlocks) {
  const TemporaryFolder folder;
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const std::size_t count : {std::size_t{0}, std::size_t{5}, ScanStream::kBlock + 77})
      expect_same(folder.write("lists.ply", ply_with_lists(format, count)));
  std::string more = ply_with_lists("ascii", 3) + "\n1 2 3\n";
  expect_same(folder.write("more.ply", more));
}

TEST(ScanStream, PcdIsTheSameInBlocks) {
  const TemporaryFolder folder;
  constexpr std::size_t kWidth = 600, kHeight = 250;
  expect_same(
      folder.write("a.pcd", pcd_header(kWidth, kHeight, "ascii") + text_points(kWidth * kHeight, 7, 12)));
  expect_same(
      folder.write("odd.pcd", pcd_header(2, 1, "ascii") + "1 2 3 4 5 6 7\n\n600000,2,3,4,5,6,7\nrest"));
  const std::string binary = pcd_header(kWidth, kHeight, "binary") + word_records(kWidth * kHeight, false);
  expect_same(folder.write("b.pcd", binary));
  expect_same(folder.write("page.pcd", binary + std::string(40, '\0')));
  expect_same(folder.write("rest.pcd", binary + "rest"));
  expect_same(folder.write("packed.pcd", testing::sample_file("pcd", "binary")));
  const std::string compressed = pcd_header(kWidth, kHeight, "binary_compressed") +
                                 testing::pcd_packed(word_records(kWidth * kHeight, false), kWords);
  const bool room = scratch_has_room();
  expect_same(folder.write("c.pcd", compressed), room);
  expect_same(folder.write("compressed_rest.pcd", compressed + "rest"), room);
  expect_same(folder.write("compressed.pcd", testing::sample_file("pcd", "binary_compressed")), room);
}

TEST(ScanStream, SamplesAreTheSameInBlocks) {
  const TemporaryFolder folder;
  for (const int rows : {1, 64, 230}) {  // of bands of 64 rows
    write_samples(folder.path() / "a.hsf", rows, 1201);
    expect_same(folder.path() / "a.hsf");
  }
}

TEST(ScanStream, DamageIsTheSameErrorInBlocks) {
  const TemporaryFolder folder;
  const auto cut = [](const std::string& bytes) { return bytes.substr(0, bytes.size() - 400); };
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"word.ptx",
                                            ptx_header(2, 2) + "1 2 3 4\n1 2 x 4\n1 2 3 4\n1 2 3 4\n"},
        {"few.pts", "3\n10 20 30\n1 2\n10 20 30\n"},
        {"absurd.pts", "3\n1 2 3\n1 2e13 3\n1 2 3\n"},
        {"word.ply",
         ply_header("ascii", 2, "float", "uchar") + "1 2 3 4 5 6 7\n1 2 x 4 5 6 7\n3 0 1 2\n3 0 1 2\n"},
        {"face.ply", ply_header("ascii", 1, "float", "uchar") + "1 2 3 4 5 6 7\n9 0 1 2\n3 0 1 2\n"},
        {"cut.ply", ply_header("binary_little_endian", 1000, "double", "ushort") + "few"},
        {"cut_list.ply", cut(ply_with_lists("binary_little_endian", 900))},
        {"cut_line.ply", cut(ply_with_lists("ascii", 900))},
        {"more.pcd", pcd_header(2, 1, "ascii") + "1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n"},
        {"cut.pcd", pcd_header(2000, 1, "binary") + "few"},
        {"cut_compressed.pcd", cut(pcd_header(20, 10, "binary_compressed") +
                                   testing::pcd_packed(word_records(200, false), kWords))},
        {"bad_compressed.pcd", pcd_header(2, 1, "binary_compressed") + testing::raw(std::uint32_t{3}) +
                                   testing::raw(std::uint32_t{68}) + "\x40\x01" + "e"}}) {
    const fs::path file = folder.write(name, bytes);
    const ScanEntry entry = list_scans(file).at(0);
    EXPECT_EQ(error_of(ErrorKind::input, [&] { stream_scan(file, entry); }),
              error_of(ErrorKind::input, [&] { read_scan(file, entry); }));
  }
}

// Nothing as large as a column of the scan is asked for.
TEST(ScanStream, MemoryIsOfBlocks) {
  const TemporaryFolder folder;
  constexpr int kCols = 1100, kRows = 1000;
  const fs::path ptx = folder.write("a.ptx", ptx_header(kCols, kRows) + text_points(kCols * kRows, 4, 5));
  const fs::path e57 = e57_of(folder.path() / "a.e57", kRows, kCols, all_nodes(kRows, kCols, true));
  const std::string records = word_records(kCols * kRows, false);
  const fs::path pcd = folder.write("a.pcd", pcd_header(kCols, kRows, "binary") + records);
  const fs::path ply =
      folder.write("a.ply", ply_header("binary_little_endian", kCols * kRows, "double", "ushort") + records +
                                std::string(2, '\0'));
  const fs::path samples = folder.path() / "a.hsf";
  write_samples(samples, kRows, kCols);
  const fs::path lists = folder.write("lists.ply", ply_with_lists("binary_little_endian", kCols * kRows));
  std::vector<fs::path> files{ptx, e57, pcd, ply, samples, lists};
  if (scratch_has_room())
    files.push_back(folder.write(
        "c.pcd", pcd_header(kCols, kRows, "binary_compressed") + testing::pcd_packed(records, kWords)));
  for (const fs::path& file : files) {
    auto entry = list_scans(file, {.exact = true}).at(0);
    entry.kept_bytes = 0;
    const testing::AllocationWatch watch;
    const auto stream = stream_scan(file, entry);
    stream->for_each_block([](const SampleBlock&) { return true; });
    EXPECT_LT(watch.largest_bytes(), std::size_t{4} * kCols * kRows) << file;
  }
}

}  // namespace hybrid::io
