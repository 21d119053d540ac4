// E57 files through range images and back: every record, every blob and every letter of the description.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>

#include "core/scratch_file.hpp"
#include "io/e57/e57_source.hpp"
#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/read_scan.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::e57_records_test {
namespace {
namespace fs = std::filesystem;

using Fields = std::vector<io::E57Field>;

constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHigh = std::numeric_limits<std::int64_t>::max();

Fields operator+(Fields a, const Fields& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Fields reals(const std::vector<std::string>& names, io::E57Type type = io::E57Type::single_real) {
  Fields fields;
  for (const std::string& name : names) fields.push_back(real_field(name, type));
  return fields;
}

const std::vector<std::string> kXyz = {"cartesianX", "cartesianY", "cartesianZ"};
const Fields kScaled = {scaled_field("cartesianX", -8'388'608, 8'388'607, 1e-5, 0.125),
                        scaled_field("cartesianY", kLow, kHigh, 1e-18),
                        scaled_field("cartesianZ", 5, 40'000, 0.001)};
const Fields kState = {integer_field("cartesianInvalidState", 0, 2)};
const Fields kColours = {integer_field("colorRed", 0, 255), integer_field("colorGreen", 0, 255),
                         integer_field("colorBlue", 0, 65535), integer_field("isColorInvalid", 0, 1)};
const Fields kOther = {integer_field("returnIndex", 0, 3),
                       integer_field("returnCount", 1, 4),
                       real_field("timeStamp", io::E57Type::double_real),
                       integer_field("nor:reflectance", -7, -7),
                       real_field("nor:normalX"),
                       scaled_field("intensity", 0, 4095, 0.25, -3),
                       integer_field("isIntensityInvalid", 0, 1),
                       integer_field("x", 0, 99),
                       real_field("x.lo"),
                       integer_field("z.lo", 0, (1ll << 40))};

// How the records of a test's scan lie on their grid.
enum class Grid { none, rows, columns, shuffled_with_gaps, several_returns, far_apart };

struct Made {
  io::E57Scan scan;
  E57Columns columns;
};

Made make_scan(Fields fields, Grid grid, std::size_t count) {
  const std::int64_t rows = 37;
  if (grid != Grid::none)
    fields = fields +
             Fields{integer_field("rowIndex", -5, 10'000'000), integer_field("columnIndex", 0, 10'000'000)};
  Made made;
  made.scan.points.fields = fields;
  made.columns = random_columns(fields, count);
  if (grid == Grid::none) return made;
  auto& row = made.columns.integers[fields.size() - 2];
  auto& column = made.columns.integers[fields.size() - 1];
  std::vector<std::int64_t> node(count);
  std::iota(node.begin(), node.end(), 0);
  std::mt19937 random(5);
  if (grid == Grid::shuffled_with_gaps)
    for (std::int64_t& at : node) at *= 2;
  if (grid == Grid::several_returns)
    for (std::int64_t& at : node) at = at * 3 / 5;
  if (grid == Grid::shuffled_with_gaps || grid == Grid::several_returns) std::ranges::shuffle(node, random);
  const auto cols = static_cast<std::int64_t>(count) / rows + 1;
  for (std::size_t i = 0; i < count; ++i) {
    row[i] = (grid == Grid::rows ? node[i] / cols : node[i] % rows) - 5;
    column[i] = (grid == Grid::rows ? node[i] % cols : node[i] / rows) + 3;
    if (grid == Grid::far_apart) column[i] *= 10'000;
  }
  return made;
}

void write(const fs::path& file, const std::vector<Made>& scans, std::size_t images,
           const std::string& crs = {}) {
  io::E57Writer writer(file, {.coordinate_system = crs, .extensions = {{"nor", "http://example.org/nor"}}});
  for (std::size_t k = 0; k < scans.size(); ++k) {
    writer.begin_scan(scans[k].scan);
    writer.write(scans[k].columns.records());
    writer.end_scan();
    for (std::size_t i = 0; k == 0 && i < images; ++i) {
      std::string picture(3000 * i + 5, 'p');
      std::iota(picture.begin(), picture.end(), '\0');
      const std::string mask(i, 'm');
      writer.add_image({.name = fmt::format("image {}", i), .width = 4, .height = 3}, picture, mask);
    }
  }
  writer.close();
}

// Through range images, one per scan, all of them back into `back`.
std::vector<fs::path> to_images(const fs::path& file, const fs::path& folder) {
  const io::E57FileSource source(file);
  EXPECT_TRUE(source.dropped().empty());
  const std::string sums = io::write_exr_parts(source, folder / "a.parts");
  std::vector<fs::path> images;
  for (std::size_t k = 0; k < source.contents().scans.size(); ++k) {
    images.push_back(folder / fmt::format("a-{}.exr", k));
    io::write_exr_scan(source, k, images.back(), folder / "a.parts", sums);
  }
  return images;
}

void back_and_forth(const fs::path& file, const fs::path& back, const fs::path& folder) {
  auto images = to_images(file, folder);
  std::ranges::reverse(images);
  io::copy_e57(io::ExrSource(images), back);
}

std::string without_offsets(const io::E57File& file) {
  const std::string xml = file.xml();
  std::vector<io::TextEdit> edits;
  for (const io::E57Part& part : io::outline_e57_xml(file.name(), xml).parts)
    edits.push_back({part.offset_text, {}});
  return io::edited(xml, edits);
}

// By the raw blocks of both, which the range images had no part in.
void expect_same(const fs::path& one, const fs::path& other) {
  const io::E57File a(one), b(other);
  EXPECT_EQ(without_offsets(a), without_offsets(b));
  ASSERT_EQ(a.contents().scans.size(), b.contents().scans.size());
  for (std::size_t k = 0; k < a.contents().scans.size(); ++k) {
    const io::E57Table &x = a.contents().scans[k].points, &y = b.contents().scans[k].points;
    EXPECT_EQ(x.count, y.count);
    EXPECT_TRUE(x.fields == y.fields);
    if (x.count == 0) continue;
    const E57Columns stored = read_columns(a, k, 1 << 20), found = read_columns(b, k, 1 << 20);
    for (std::size_t f = 0; f < x.fields.size(); ++f) {
      EXPECT_TRUE(stored.integers[f] == found.integers[f]) << x.fields[f].name;
      ASSERT_EQ(stored.reals[f].size(), found.reals[f].size());
      EXPECT_TRUE(stored.reals[f].empty() ||
                  std::memcmp(stored.reals[f].data(), found.reals[f].data(), 8 * stored.reals[f].size()) == 0)
          << x.fields[f].name;
    }
  }
  ASSERT_EQ(a.contents().images.size(), b.contents().images.size());
  for (std::size_t k = 0; k < a.contents().images.size(); ++k) {
    const io::E57Image &x = a.contents().images[k], &y = b.contents().images[k];
    EXPECT_EQ(a.read_blob(x.picture, ""), b.read_blob(y.picture, ""));
    ASSERT_EQ(x.mask.has_value(), y.mask.has_value());
    if (x.mask) {
      EXPECT_EQ(a.read_blob(*x.mask, ""), b.read_blob(*y.mask, ""));
    }
  }
}

}  // namespace

TEST(E57Records, EveryPrototypeAndOrderComesBackByteForByte) {
  const Fields prototypes[] = {
      kScaled + kState + kColours + kOther,
      reals(kXyz) + kState,
      reals(kXyz, io::E57Type::double_real) + kColours,
      reals({"sphericalRange", "sphericalAzimuth", "sphericalElevation"}, io::E57Type::double_real) +
          Fields{integer_field("sphericalInvalidState", 0, 2)},
      {integer_field("cartesianX", -9, 9), integer_field("cartesianY", kLow, kHigh),
       integer_field("cartesianZ", 0, 4'294'967'295)},
      {integer_field("cartesianX", 0, 0), integer_field("cartesianY", 1, 1), real_field("cartesianZ")},
  };
  for (const Fields& prototype : prototypes)
    for (const Grid grid : {Grid::none, Grid::rows, Grid::columns, Grid::shuffled_with_gaps,
                            Grid::several_returns, Grid::far_apart})
      for (const std::size_t count : {700u, 2u, 12'345u}) {
        if (count != 700 && &prototype != &prototypes[0]) continue;
        SCOPED_TRACE(
            fmt::format("{} fields, grid {}, {} records", prototype.size(), static_cast<int>(grid), count));
        const TemporaryFolder folder;
        const auto file = folder.path() / "a.e57", back = folder.path() / "back.e57";
        write(file, {make_scan(prototype, grid, count)}, 0);
        back_and_forth(file, back, folder.path());
        expect_same(file, back);
        EXPECT_TRUE(bytes_of(file) == bytes_of(back));
        const io::ExrRecords records(folder.path() / "a-0.exr");
        if (count < 100) continue;  // too few to tell
        const bool on_grid = grid != Grid::none && grid != Grid::far_apart;
        EXPECT_EQ(records.layout().grid(), on_grid);
        EXPECT_EQ(records.layout().has_list(), !on_grid || grid == Grid::several_returns);
        if (grid == Grid::columns || grid == Grid::rows) {
          EXPECT_EQ(records.layout().by_columns, grid == Grid::columns);
        }
      }
}

// Columns in no order: every group of tiles has records from everywhere, and all places are kept.
TEST(E57Records, ColumnsInNoOrderComeBackByteForByte) {
  const TemporaryFolder folder;
  constexpr std::int64_t kRows = 20, kCols = 901;  // four groups of tiles
  Made made = make_scan(reals(kXyz), Grid::columns, kRows * kCols);
  const std::size_t fields = made.scan.points.fields.size();
  for (std::int64_t i = 0; i < kRows * kCols; ++i) {
    made.columns.integers[fields - 2][static_cast<std::size_t>(i)] = i % kRows;
    made.columns.integers[fields - 1][static_cast<std::size_t>(i)] = i / kRows * 7 % kCols;
  }
  const auto file = folder.path() / "a.e57", back = folder.path() / "back.e57";
  write(file, {made}, 0);
  back_and_forth(file, back, folder.path());
  EXPECT_TRUE(io::ExrRecords(folder.path() / "a-0.exr").layout().by_columns);
  EXPECT_TRUE(bytes_of(file) == bytes_of(back));
}

// No float and no pair of them holds these.
TEST(E57Records, DoublesKeepAllTheirBits) {
  const TemporaryFolder folder;
  Made made = make_scan(reals(kXyz, io::E57Type::double_real) + reals({"intensity"}), Grid::none, 7);
  const double values[] = {0x1.fffffffffffffp0, 5e-324, -0.0, 1e300, -1e-300, INFINITY, 1.0 / 3};
  made.columns.reals[0].assign(std::begin(values), std::end(values));
  made.columns.reals[3] = {0x1p-149, -0.0, 3.4e38f, INFINITY, NAN, 1, 2};
  const auto file = folder.path() / "a.e57", back = folder.path() / "back.e57";
  write(file, {made}, 0);
  back_and_forth(file, back, folder.path());
  expect_same(file, back);
  EXPECT_TRUE(bytes_of(file) == bytes_of(back));
}

TEST(E57Records, SeveralScansPicturesAndWhatNobodyKnows) {
  const TemporaryFolder folder;
  std::vector<Made> scans = {make_scan(kScaled + kOther, Grid::columns, 700),
                             make_scan(reals(kXyz), Grid::none, 3), make_scan(kScaled, Grid::rows, 0),
                             make_scan(reals(kXyz), Grid::rows, 1)};
  for (std::size_t k = 0; k < scans.size(); ++k) {
    scans[k].scan.name = fmt::format("scan <{}> & \"more\"", k);
    scans[k].scan.guid = fmt::format("{{{}}}", k);
    scans[k].scan.sensor = "scanner";
    scans[k].scan.world_from_scan = Pose{1, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Vec3(1, 2.5, -1e6 / 3)};
    scans[k].scan.intensity = io::E57Limits{-0.1, 1.0 / 3};
  }
  const auto plain = folder.path() / "plain.e57", file = folder.path() / "a.e57",
             back = folder.path() / "back.e57";
  write(plain, scans, 3, "LOCAL_CS[\"hall\"]");
  std::ofstream(file, std::ios::binary) << with_xml(
      bytes_of(plain), "<sensorModel type=\"String\">scanner</sensorModel>",
      "<sensorVendor type='String'><![CDATA[a < b]]></sensorVendor><!-- <points> -->\n\t<temperature "
      "type=\"Float\">21.50</temperature><acquisitionStart type=\"Structure\"><dateTimeValue "
      "type=\"Float\">1.1e9</dateTimeValue></acquisitionStart><nor:what nor:why=\"yes\" type=\"String\"/>");
  back_and_forth(file, back, folder.path());
  expect_same(file, back);
  const io::E57File read(back);
  EXPECT_NE(read.xml().find("<temperature type=\"Float\">21.50</temperature>"), std::string::npos);
  EXPECT_NE(read.xml().find("<![CDATA[a < b]]></sensorVendor><!-- <points> -->"), std::string::npos);
  EXPECT_TRUE(bytes_of(file) == bytes_of(back));
}

TEST(E57Records, SomeScansOfAFileBringTheirPicturesAlone) {
  const TemporaryFolder folder;
  std::vector<Made> scans = {make_scan(reals(kXyz), Grid::none, 3), make_scan(reals(kXyz), Grid::rows, 500)};
  scans[0].scan.guid = "{first}";
  scans[1].scan.guid = "{second}";
  const auto file = folder.path() / "a.e57", back = folder.path() / "back.e57",
             one = folder.path() / "one.e57";
  {
    io::E57Writer writer(file);
    for (const Made& made : scans) {
      writer.begin_scan(made.scan);
      writer.write(made.columns.records());
      writer.end_scan();
    }
    for (const char* guid : {"{first}", "{second}", ""})
      writer.add_image({.name = guid, .scan_guid = guid, .width = 1, .height = 1}, std::string("picture"));
    writer.close();
  }
  const io::E57FileSource second(file, std::set<std::size_t>{1});
  EXPECT_EQ(second.dropped(), std::vector<std::string>{"photographs of the other scans (1)"});
  io::copy_e57(second, one);
  const io::E57File read(one);
  ASSERT_EQ(read.contents().scans.size(), 1u);
  EXPECT_EQ(read.contents().scans[0].guid, "{second}");
  ASSERT_EQ(read.contents().images.size(), 2u);
  EXPECT_EQ(read.contents().images[1].name, "");
  EXPECT_TRUE(read_columns(read, 0) == scans[1].columns);
  // One image of several: the other scan is left out of the file.
  const auto images = to_images(file, folder.path());
  io::copy_e57(io::ExrSource({images[1]}), back);
  EXPECT_TRUE(read_columns(io::E57File(back), 0) == scans[1].columns);
  EXPECT_EQ(io::E57File(back).contents().images.size(), 3u);
}

// What a run is given is the same, whichever of both it reads.
TEST(E57Records, ARangeImageIsTheSameScanAsItsFile) {
  for (const Grid grid : {Grid::none, Grid::columns, Grid::several_returns}) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "a.e57";
    Made made = make_scan(reals(kXyz, io::E57Type::double_real) + kState + kColours + kOther, grid, 3000);
    for (double& x : made.columns.reals[0]) x += 530'000;
    made.scan.intensity = io::E57Limits{0, 4095};
    made.scan.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), Vec3(1, 2, 3)};
    write(file, {made}, 0, "EPSG:27700");
    const auto image = to_images(file, folder.path()).front();
    fs::rename(image, folder.path() / "a.exr");
    const Scan a = io::read_scan(file, 0), b = io::read_scan(folder.path() / "a.exr", 0);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.crs, b.crs);
    EXPECT_EQ(a.notes, b.notes);
    EXPECT_EQ(a.origin, b.origin);
    ASSERT_EQ(a.points.size(), b.points.size());
    EXPECT_EQ(std::memcmp(a.points.data(), b.points.data(), 12 * a.points.size()), 0);
    EXPECT_TRUE(a.intensity == b.intensity && a.rgb == b.rgb && a.node == b.node);
    EXPECT_EQ(a.grid_rows, b.grid_rows);
    EXPECT_EQ(a.row_by_row, b.row_by_row);
    EXPECT_EQ(row_major(*a.world_from_scan), row_major(*b.world_from_scan));
    const auto entry = io::list_scans(folder.path() / "a.exr").front();
    EXPECT_EQ(entry.samples, 3000u);
    EXPECT_EQ(entry.grid_rows > 0, grid != Grid::none);
    EXPECT_NE(entry.structure.find("intensity (whole 0 to 4095, times 0.25, plus -3)"), std::string::npos);
  }
}

// What was decoded once is not asked of the file again; without a disk to keep it on, a file that was changed
// meanwhile is told.
TEST(E57Records, TilesAreDecodedOnce) {
  const char* before = std::getenv("TMPDIR");
  const std::string folder_before = before != nullptr ? before : "";
  for (const bool disk : {true, false}) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "a.e57", back = folder.path() / "back.e57";
    write(file, {make_scan(kScaled + kColours + kOther, Grid::columns, 30'000)}, 0);
    const auto image = to_images(file, folder.path()).front();
    setenv("TMPDIR", disk ? "/var/tmp" : "/no/such/folder", 1);
    const bool kept = ScratchFile::make(1 << 24) != nullptr;
    const io::ExrSource source({image});
    const auto records = source.open(0);
    if (before != nullptr)
      setenv("TMPDIR", folder_before.c_str(), 1);
    else
      unsetenv("TMPDIR");
    if (disk && !kept) GTEST_SKIP() << "/var/tmp is no disk with a little room";
    const auto half = static_cast<std::streamoff>(fs::file_size(image) / 2);
    std::fstream(image, std::ios::in | std::ios::out | std::ios::binary).seekp(half)
        << std::string(static_cast<std::size_t>(half), '\0');
    const io::E57File stored(file);
    const E57Columns expected = read_columns(stored, 0);
    std::vector<std::size_t> fields(source.table(0).fields.size());
    std::iota(fields.begin(), fields.end(), 0);
    const auto compare = [&](const std::vector<std::size_t>& some) {
      records->read(some, 0, records->count(), [&](const io::E57Records& range) {
        for (std::size_t k = 0; k < some.size(); ++k) {
          EXPECT_TRUE(std::ranges::equal(
              range.integers[k],
              std::span(expected.integers[some[k]])
                  .subspan(range.integers[k].empty() ? 0 : range.first, range.integers[k].size())));
          EXPECT_TRUE(std::ranges::equal(
              range.reals[k], std::span(expected.reals[some[k]])
                                  .subspan(range.reals[k].empty() ? 0 : range.first, range.reals[k].size())));
        }
      });
    };
    if (!disk) {
      expect_input_error([&] { compare(fields); }, {"a-0.exr", "the file was changed meanwhile"});
      continue;
    }
    compare(fields);
    compare({fields[0], fields.back()});
  }
}

TEST(E57Records, DamageIsFound) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.e57", other = folder.path() / "b.e57",
             back = folder.path() / "back.e57";
  write(file, {make_scan(kScaled, Grid::columns, 500), make_scan(kScaled, Grid::none, 20)}, 1);
  write(other, {make_scan(kScaled, Grid::rows, 400)}, 0);
  const auto images = to_images(file, folder.path());
  const auto refused = [&](const std::vector<fs::path>& some, const std::vector<std::string>& parts) {
    expect_input_error([&] { io::copy_e57(io::ExrSource(some), back); }, parts);
    EXPECT_FALSE(fs::exists(back));
  };
  refused({images[0], images[0]}, {"a-0.exr", "found scan 0 again"});
  fs::create_directory(folder.path() / "b");
  refused({images[0], to_images(other, folder.path() / "b")[0]}, {"found another file's"});
  // The description, a layout that hides records, a picture that is gone.
  const std::string good = bytes_of(images[0]);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    std::ofstream(images[0], std::ios::binary) << bad;
  };
  with("scale=\"1e-05\"", "scale=\"1e-06\"");
  refused({images[0]}, {"a-0.exr: content: expected 500 records and checksum"});
  with("grid 37 14", "grid 37 15");
  refused({images[0]}, {"a-0.exr: header", "hybrid:layout says"});
  with("a.parts", "../etc ");
  refused({images[0]}, {"hybrid:e57_parts", "name of a folder"});
  std::ofstream(images[0], std::ios::binary) << good;
  for (const auto& part : fs::directory_iterator(folder.path() / "a.parts")) {
    const std::string picture = bytes_of(part.path());
    std::ofstream(part.path(), std::ios::binary) << "too short";
    refused({images[0]}, {"jpegImage", "found 9"});
    std::string changed = picture;
    changed.back() ^= 1;
    std::ofstream(part.path(), std::ios::binary) << changed;
    refused({images[0]}, {"jpegImage", "checksum", "copy the folder again"});
    fs::rename(part.path(), folder.path() / "away");
    refused({images[0]}, {"jpegImage", "copy the folder a.parts"});
    fs::rename(folder.path() / "away", part.path());
    break;
  }
}

}  // namespace hybrid::testing::e57_records_test
