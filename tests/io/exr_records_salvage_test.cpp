// Range images with records of which tiles are damaged or missing: the records of the others are used.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "io/e57_grids.hpp"
#include "io/e57_scans.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/read_scan.hpp"
#include "io/same_in_blocks.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::exr_records_salvage_test {
namespace {
namespace fs = std::filesystem;

constexpr int kRows = 600, kCols = 700;  // 3 x 3 tiles

class ExrRecordsSalvage : public ::testing::Test {
 protected:
  void make(const std::vector<std::uint32_t>& order) {
    const fs::path file = folder_.path() / "a.e57";
    e57_of(file, kRows, kCols, order);
    io::write_exr_scan(io::E57FileSource(file), 0, image_, {});
    good_ = bytes_of(image_);
    columns_ = read_columns(io::E57File(file), 0);
  }

  // Strictly refused; in salvage the records of the tiles that are left, each as it was. How many.
  std::uint64_t expect_saved(const std::string& bytes, bool in_blocks = false) {
    folder_.write("a.exr", bytes);
    const fs::path copy = folder_.path() / "copy.e57";
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { io::copy_e57(io::ExrSource({image_}), copy); }),
                      "or use --salvage"));
    const io::ExrSource source({image_}, true);
    notes_ = source.notes(0);
    io::copy_e57(source, copy);
    const io::E57File read(copy);
    const E57Columns left = read_columns(read, 0);
    // By their node, which no other record has.
    std::vector<std::size_t> record(static_cast<std::size_t>(kRows) * kCols, ~std::size_t{0});
    const auto node = [](const E57Columns& columns, std::size_t i) {
      return static_cast<std::size_t>((columns.integers[4][i] - 7) * kCols + columns.integers[5][i]);
    };
    for (std::size_t i = 0; i < columns_.records().count; ++i) record[node(columns_, i)] = i;
    const std::size_t count = left.records().count;
    std::size_t before = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t original = record.at(node(left, i));
      EXPECT_TRUE(i == 0 || original > before) << i;  // in their order
      before = original;
      for (std::size_t k = 0; k < left.integers.size(); ++k)
        if (left.integers[k][i] != columns_.integers[k][original]) ADD_FAILURE() << i << " " << k;
    }
    EXPECT_EQ(read.contents().scans[0].points.count, count);
    if (in_blocks) expect_same(image_, true, true);
    return count;
  }
  // With other bytes within the tile at this share of the file.
  std::string damaged(double share) const {
    std::string bytes = good_;
    return bytes.replace(static_cast<std::size_t>(share * static_cast<double>(bytes.size())), 64,
                         std::string(64, '\x55'));
  }

  TemporaryFolder folder_;
  const fs::path image_ = folder_.path() / "a.exr";
  std::string good_;
  E57Columns columns_;
  std::vector<std::string> notes_;
};

TEST_F(ExrRecordsSalvage, ATileCostsOnlyItself) {
  constexpr std::uint64_t kAll = std::uint64_t{kRows} * kCols, kTile = 256 * 256;
  auto shuffled = all_nodes(kRows, kCols, true);
  std::ranges::shuffle(shuffled, std::mt19937(4));
  for (const auto& order : {all_nodes(kRows, kCols, true), all_nodes(kRows, kCols, false), shuffled}) {
    make(order);
    const std::uint64_t left = expect_saved(damaged(0.5), order != shuffled);
    EXPECT_GE(left, kAll - kTile);
    EXPECT_LT(left, kAll);
    ASSERT_EQ(notes_.size(), 2u);
    EXPECT_TRUE(holds(notes_[0], "1 of 9 tiles of 256 x 256 nodes are damaged, the first at row "));
    EXPECT_TRUE(holds(notes_[1], fmt::format("{} of {} points (", kAll - left, kAll)));
    // The end of the file, with some tiles.
    const std::uint64_t some = expect_saved(good_.substr(0, good_.size() * 6 / 10));
    EXPECT_GT(some, kAll / 4);
    EXPECT_LT(some, kAll * 3 / 4);
  }
}

// One bit, wherever it is within the tiles: none of what it changes is taken for good.
TEST_F(ExrRecordsSalvage, OneBit) {
  make(all_nodes(kRows, kCols, true));
  std::mt19937 random(7);
  for (int i = 0; i < 6; ++i) {
    std::string bytes = good_;
    const std::size_t at = bytes.size() / 5 + random() % (bytes.size() / 5 * 4);
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
    expect_saved(bytes);
  }
}

TEST_F(ExrRecordsSalvage, WhatIsWholeStays) {
  make(all_nodes(kRows, kCols, true));
  const fs::path copy = folder_.path() / "copy.e57";
  const io::ExrSource source({image_}, true);
  EXPECT_TRUE(source.notes(0).empty());
  io::copy_e57(source, copy);
  EXPECT_EQ(bytes_of(copy), bytes_of(folder_.path() / "a.e57"));
}

// The header says what the channels mean: damaged, it could say anything. Without the checksums of tiles, as
// in older images, what is whole is read, and nothing else.
TEST_F(ExrRecordsSalvage, ADamagedHeader) {
  make(all_nodes(kRows, kCols, true));
  const auto with = [&](std::string bytes, const std::string& from, const std::string& to) {
    folder_.write("a.exr", bytes.replace(bytes.find(from), from.size(), to));
  };
  const auto refused = [&] { return error_of(ErrorKind::input, [&] { io::ExrSource({image_}, true); }); };
  with(good_, "scale=\"0.0001\"", "scale=\"0.0002\"");
  EXPECT_TRUE(holds(refused(), "content: expected 420000 records and checksum"));
  with(damaged(0.5), "hybrid:tile_xxh3", "hybrid:tile_xxh4");
  EXPECT_TRUE(holds(refused(), "no checksums of tiles by which salvage could tell damaged ones"));
  with(good_, "hybrid:tile_xxh3", "hybrid:tile_xxh4");
  io::copy_e57(io::ExrSource({image_}, true), folder_.path() / "copy.e57");
  EXPECT_EQ(bytes_of(folder_.path() / "copy.e57"), bytes_of(folder_.path() / "a.e57"));
}

TEST_F(ExrRecordsSalvage, APictureThatIsGone) {
  const fs::path file = folder_.path() / "a.e57", parts = folder_.path() / "a.parts",
                 copy = folder_.path() / "copy.e57";
  io::E57Scan scan;
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(real_field(axis));
  {
    io::E57Writer writer(file);
    writer.begin_scan(scan);
    writer.write(random_columns(scan.points.fields, 100).records());
    writer.end_scan();
    for (const char* name : {"first", "second"})
      writer.add_image({.name = name, .width = 4, .height = 3}, std::string(name));
    writer.close();
  }
  const io::E57FileSource original(file);
  io::write_exr_scan(original, 0, image_, parts, io::write_exr_parts(original, parts));
  for (const auto& part : fs::directory_iterator(parts))
    if (bytes_of(part.path()) == "first") fs::remove(part.path());
  const io::ExrSource source({image_}, true);
  ASSERT_EQ(source.dropped().size(), 1u);
  EXPECT_TRUE(holds(source.dropped()[0], "photograph first (damaged: ")) << source.dropped()[0];
  io::copy_e57(source, copy);
  ASSERT_EQ(io::E57File(copy).contents().images.size(), 1u);
  EXPECT_EQ(io::E57File(copy).contents().images[0].name, "second");
}

}  // namespace
}  // namespace hybrid::testing::exr_records_salvage_test
