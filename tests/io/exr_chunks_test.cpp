// Tiles and blocks of lines whose data end too early, which the library takes for whole.
#include "io/exr/exr_chunks.hpp"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <array>
#include <cmath>
#include <cstring>

#include "io/exr/exr_header.hpp"
#include "io/exr/exr_scan.hpp"
#include "io/foreign_exr.hpp"
#include "io/scan_files.hpp"
#include "io/truth.hpp"

namespace hybrid::testing::exr_chunks_test {
namespace {

constexpr int kWidth = 40, kHeight = 300, kTile = 16;
constexpr std::array kCompressions = {Imf::NO_COMPRESSION,  Imf::RLE_COMPRESSION,  Imf::ZIPS_COMPRESSION,
                                      Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION,  Imf::PXR24_COMPRESSION,
                                      Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION,
                                      Imf::DWAB_COMPRESSION};

std::string deflated(std::size_t zeros) {
  const std::string bytes(zeros, '\0');
  std::string packed(bytes.size() + 100, '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  packed.resize(
      libdeflate_zlib_compress(compressor, bytes.data(), bytes.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  return packed;
}

Imf::ChannelList channels() {
  Imf::ChannelList list;
  list.insert("range", Imf::Channel(Imf::FLOAT));
  list.insert("R", Imf::Channel(Imf::HALF));
  return list;
}

std::string problem(Imf::Compression compression, const std::string& chunk) {
  return io::exr_chunk_problem(compression, channels(), {3, -2, 12, 7}, chunk);  // 10 x 10: 600 bytes
}

std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data() + at, size);
  return number;
}

TEST(ExrChunks, OfEveryCompressionAnEmptyOneIsToldFromOneThatIsStoredAsItIs) {
  for (const Imf::Compression compression : kCompressions) {
    SCOPED_TRACE(compression);
    EXPECT_EQ(problem(compression, std::string(600, '\x01')), "");
    EXPECT_TRUE(holds(problem(compression, ""), "bytes of pixels in 10 x 10 from (3, -2), found 0"));
  }
}

TEST(ExrChunks, WhatEndsEarlyIsFound) {
  EXPECT_TRUE(holds(problem(Imf::NO_COMPRESSION, std::string(599, ' ')), "expected 600 bytes"));
  std::string runs;
  for (int i = 0; i < 4; ++i) runs += "\x7f.";  // 128 times
  EXPECT_TRUE(holds(problem(Imf::RLE_COMPRESSION, runs), "found 512"));
  EXPECT_EQ(problem(Imf::RLE_COMPRESSION, runs + "\xa8" + std::string(88, '-')), "");  // 88 bytes as they are
  EXPECT_TRUE(holds(problem(Imf::RLE_COMPRESSION, runs + "\xa9" + std::string(87, '-')), "found 599"));
  for (const Imf::Compression compression : {Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    EXPECT_EQ(problem(compression, deflated(600)), "");
    EXPECT_TRUE(holds(problem(compression, deflated(599)), "expected 600 bytes"));
    EXPECT_EQ(problem(compression, "not deflated"), "") << "the library finds that";
  }
}

// The one block of an image of light, coverage and ranges, as the library writes it.
std::string dwa_block(const Imf::ChannelList& list, const io::ExrChunkBox& box) {
  const ScanFolder folder;
  ForeignExr exr(box.right - box.left + 1, box.bottom - box.top + 1);
  exr.compression = Imf::DWAA_COMPRESSION;
  exr.corner = {box.left, box.top};
  for (auto at = list.begin(); at != list.end(); ++at) exr.add(at.name(), at.channel().type);
  exr.write(folder.path("a.exr"));
  const std::string bytes = bytes_of(folder.path("a.exr"));
  io::InputFile input(folder.path("a.exr"));
  const std::uint64_t at = number_at(bytes, io::check_exr_header(input).end, 8);
  return bytes.substr(at + 8, number_at(bytes, at + 4, 4));
}

TEST(ExrChunks, OfDwaEachKindOfDataIsMeasured) {
  Imf::ChannelList list;
  for (const char* name : {"R", "G", "B", "A"}) list.insert(name, Imf::Channel(Imf::HALF));
  list.insert("left.range", Imf::Channel(Imf::FLOAT));
  const io::ExrChunkBox box{3, -2, 42, 17};  // 40 x 20: blocks of 8 x 8 are 5 x 3
  const std::string good = dwa_block(list, box);
  const auto found = [&](const std::string& chunk) {
    return io::exr_chunk_problem(Imf::DWAA_COMPRESSION, list, box, chunk);
  };
  EXPECT_EQ(found(good), "");
  EXPECT_TRUE(holds(found(good.substr(0, 87)), "found 0"));
  EXPECT_TRUE(holds(found(good.substr(0, 89)), "found 0")) << "without its rules";
  const auto with_number = [&](std::size_t which, std::uint64_t value) {
    std::string chunk = good;
    std::memcpy(chunk.data() + 8 * which, &value, 8);
    return chunk;
  };
  EXPECT_TRUE(holds(found(with_number(1, 3199)),
                    "expected 3200 bytes of pixels in 40 x 20 from (3, -2), found 3199"));
  EXPECT_TRUE(holds(found(with_number(2, 0)), "expected 3200 bytes"));
  EXPECT_TRUE(holds(found(with_number(3, 0)), "expected 90 bytes")) << "of three channels' means";
  EXPECT_TRUE(holds(found(with_number(4, 0)), "expected 90 bytes"));
  EXPECT_TRUE(holds(found(with_number(9, 44)), "expected 90 bytes"));
  EXPECT_TRUE(holds(found(with_number(7, 1599)), "expected 1600 bytes"));

  // Deflated ranges that end early, though the numbers say otherwise.
  const std::size_t rules = number_at(good, 88, 2), ranges = number_at(good, 16, 8);
  std::string early = deflated(3199);
  ASSERT_LE(early.size(), ranges);
  early.resize(ranges);
  EXPECT_TRUE(holds(found(std::string(good).replace(88 + rules, ranges, early)), "expected 3200 bytes"));

  // Version 1 knows its rules by heart, and there they are the same.
  std::string chunk = with_number(0, 1);
  chunk.erase(88, rules);
  EXPECT_EQ(found(chunk), "");
  EXPECT_TRUE(holds(found(chunk.replace(72, 8, std::string(8, '\0'))), "expected 90 bytes"));
}

TEST(ExrChunks, ChannelsOfFewerSamplesTakeFewerBytes) {
  Imf::ChannelList list;
  list.insert("range", Imf::Channel(Imf::FLOAT, 3, 2));
  // Columns 3, 6, 9, 12; lines -2, 0, 2, 4, 6.
  EXPECT_EQ(io::exr_chunk_problem(Imf::NO_COMPRESSION, list, {3, -2, 12, 7}, std::string(80, ' ')), "");
  EXPECT_NE(io::exr_chunk_problem(Imf::NO_COMPRESSION, list, {3, -2, 12, 7}, std::string(79, ' ')), "");
  EXPECT_EQ(io::exr_chunk_problem(Imf::ZIP_COMPRESSION, list, {4, -1, 5, -1}, ""), "") << "none";
}

// The file's second tile or block says that it has no bytes: the library would give what memory held.
TEST(ExrChunks, AnEmptyOneInAFileIsRefusedAndWithSalvageAllThatIsLost) {
  const ScanFolder folder;
  for (const Imf::Compression compression : kCompressions)
    for (const int tile : {0, kTile}) {
      SCOPED_TRACE(fmt::format("compression {} tile {}", int(compression), tile));
      ForeignExr exr(kWidth, kHeight);
      exr.compression = compression;
      exr.tile = tile;
      exr.corner = {5, -7};
      for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
      exr.write(folder.path("good.exr"));
      const Scan good = io::read_exr_scan(folder.path("good.exr"), {});
      std::string bytes = bytes_of(folder.path("good.exr"));
      io::InputFile input(folder.path("good.exr"));
      const std::uint64_t table = io::check_exr_header(input).end, chunk = number_at(bytes, table + 8, 8);
      bytes.replace(chunk + (tile > 0 ? 16 : 4), 4, std::string(4, '\0'));
      const auto file = folder.write("bad.exr", bytes);
      expect_input_error([&] { io::read_exr_scan(file, {}); },
                         {file.string(), "bytes of pixels", "--salvage"});

      const Scan scan = io::read_exr_scan(file, {.salvage = true});
      const int lines = io::exr_block_lines(compression);
      std::size_t lost = 0;
      for (int row = 0; row < kHeight; ++row)
        for (int col = 0; col < kWidth; ++col) {
          const std::size_t i = static_cast<std::size_t>(row * kWidth + col);
          const bool gone = tile > 0 ? row < kTile && col / kTile == 1 : row / lines == 1;
          lost += gone;
          EXPECT_EQ(std::isnan(scan.points[i][0]), gone) << row << " " << col;
          if (!gone) {
            EXPECT_EQ(scan.points[i], good.points[i]) << row << " " << col;
          }
        }
      EXPECT_TRUE(holds(fmt::format("{}", fmt::join(scan.notes, "\n")),
                        fmt::format("{} of {} points", lost, kWidth * kHeight)));
    }
}

TEST(ExrChunks, AnEmptyOneInTheTruthOfASceneIsRefused) {
  const ScanFolder folder;
  ForeignExr exr(kWidth, kHeight);
  for (const char* name : {"kind", "plane"}) exr.add(name, Imf::UINT);
  exr.write(folder.path("truth.exr"));
  const auto file = folder.write(
      "truth.json", fmt::format(R"({{"scans": [{{"id": "a", "truth_image": "truth.exr", "samples": {},
      "world_from_scan": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}]}})",
                                kWidth * kHeight));
  EXPECT_EQ(io::read_truth(file).scans.at(0).plane.size(), std::size_t(kWidth * kHeight));
  std::string bytes = bytes_of(folder.path("truth.exr"));
  io::InputFile input(folder.path("truth.exr"));
  bytes.replace(number_at(bytes, io::check_exr_header(input).end + 8, 8) + 4, 4, std::string(4, '\0'));
  folder.write("truth.exr", bytes);
  expect_input_error([&] { io::read_truth(file); }, {"truth.exr: tiles:", "bytes of pixels", "found 0"});
}

// A program that is ended while it writes leaves a table of nothing: tiles are found one behind the other.
TEST(ExrChunks, WithoutItsTableAFileOfTilesIsSalvaged) {
  const ScanFolder folder;
  ForeignExr exr(kWidth, kHeight);
  exr.tile = kTile;
  for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
  exr.write(folder.path("good.exr"));
  std::string bytes = bytes_of(folder.path("good.exr"));
  io::InputFile input(folder.path("good.exr"));
  const std::size_t tiles = ((kWidth - 1) / kTile + 1) * ((kHeight - 1) / kTile + 1);
  bytes.replace(io::check_exr_header(input).end, 8 * tiles, std::string(8 * tiles, '\0'));
  const auto file = folder.write("bad.exr", bytes);
  expect_input_error([&] { io::read_exr_scan(file, {}); }, {"some missing"});
  EXPECT_EQ(io::read_exr_scan(file, {.salvage = true}).points,
            io::read_exr_scan(folder.path("good.exr"), {}).points);
}

}  // namespace
}  // namespace hybrid::testing::exr_chunks_test
