// Tiles and blocks of lines whose data end too early, which the library takes for whole.
#include "io/exr_chunks.hpp"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <array>
#include <cmath>
#include <cstring>

#include "io/exr_header.hpp"
#include "io/exr_scan.hpp"
#include "io/foreign_exr.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
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

std::string dwa_head(std::uint64_t bytes, std::uint64_t when_deflated = 1) {
  std::string head(88, '\0');
  std::memcpy(head.data() + 8, &bytes, 8);
  std::memcpy(head.data() + 16, &when_deflated, 8);
  return head;
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
  for (const Imf::Compression compression : {Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    EXPECT_EQ(problem(compression, dwa_head(400)), "") << "range alone";
    EXPECT_TRUE(holds(problem(compression, dwa_head(399)), "expected 400 bytes"));
    EXPECT_TRUE(holds(problem(compression, dwa_head(400).substr(1)), "found 0"));
    EXPECT_TRUE(holds(problem(compression, dwa_head(400, 0)), "found 0"));
  }
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
}  // namespace hybrid::testing
