#include "io/exr/exr_parts.hpp"

#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputPart.h>
#include <gtest/gtest.h>

#include "io/exr/exr_scan.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing::exr_parts_test {
namespace {

constexpr int kWidth = 70, kHeight = 90;

// Of pixel i: range i, x y z = i, 2 i, 3 i; intensity in a part of tiles whose height does not divide ours.
struct PartsFile {
  Imath::Box2i window{{3, -2}, {3 + kWidth - 1, -2 + kHeight - 1}};
  Imath::Box2i points_window = window;
  std::string points_type = Imf::TILEDIMAGE;

  void write(const std::filesystem::path& file) const {
    std::vector<Imf::Header> headers = {
        part("distances", window, {"range"}, Imf::SCANLINEIMAGE, 0),
        part("points", points_window, {"x", "y", "z", "range"}, points_type, 64),
        part("light", window, {"intensity"}, Imf::TILEDIMAGE, 48)};
    headers[0].insert("hybrid:note", Imf::StringAttribute("of part one"));
    Imf::MultiPartOutputFile out(file.c_str(), headers.data(), 3);
    std::vector<float> values(5 * kWidth * kHeight);
    Imf::FrameBuffer buffer;
    int channel = 0;
    for (const char* name : {"range", "x", "y", "z", "intensity"}) {
      float* at = values.data() + channel * kWidth * kHeight;
      for (int i = 0; i < kWidth * kHeight; ++i)
        at[i] = static_cast<float>((channel == 0 ? 1 : channel == 4 ? 7 : channel) * (i + 1));
      // Each part in its own window.
      buffer.insert(
          name, Imf::Slice::Make(Imf::FLOAT, at, channel % 4 == 0 ? window : points_window, 4, 4 * kWidth));
      ++channel;
    }
    Imf::OutputPart distances(out, 0);
    distances.setFrameBuffer(buffer);
    distances.writePixels(kHeight);
    // The second range is not the one to read.
    std::vector<float> zero(kWidth * kHeight);
    Imf::FrameBuffer points = buffer;
    points.insert("range", Imf::Slice::Make(Imf::FLOAT, zero.data(), points_window, 4, 4 * kWidth));
    if (points_type == Imf::TILEDIMAGE) {
      Imf::TiledOutputPart tiles(out, 1);
      tiles.setFrameBuffer(points);
      tiles.writeTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);
    } else {
      Imf::OutputPart lines(out, 1);
      lines.setFrameBuffer(points);
      lines.writePixels(kHeight);
    }
    Imf::TiledOutputPart light(out, 2);
    light.setFrameBuffer(buffer);
    light.writeTiles(0, light.numXTiles() - 1, 0, light.numYTiles() - 1);
  }

 private:
  static Imf::Header part(const char* name, const Imath::Box2i& window,
                          const std::vector<std::string>& channels, const std::string& type, unsigned tile) {
    Imf::Header header(Imath::Box2i({0, 0}, {200, 200}), window);
    header.setName(name);
    header.setType(type);
    if (type == Imf::TILEDIMAGE) header.setTileDescription(Imf::TileDescription(tile, tile));
    for (const auto& channel : channels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    return header;
  }
};

void expect_scan(const std::filesystem::path& file) {
  const Scan scan = io::read_exr_scan(file);
  ASSERT_EQ(scan.grid_rows, kHeight);
  ASSERT_EQ(scan.grid_cols, kWidth);
  ASSERT_EQ(scan.points.size(), std::size_t{kWidth * kHeight});
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto n = static_cast<float>(i + 1);
    ASSERT_EQ(scan.points[i], (std::array<float, 3>{n, 2 * n, 3 * n})) << i;
    ASSERT_EQ(scan.intensity[i], 7 * n) << i;
  }
  EXPECT_EQ(scan.notes, std::vector<std::string>{"note: of part one"});
}

TEST(ExrParts, ChannelsOfSeveralPartsInLinesAndTilesAreOneImage) {
  const ScanFolder folder;
  PartsFile parts;
  parts.write(folder.path("tiles.exr"));
  expect_scan(folder.path("tiles.exr"));
  parts.points_type = Imf::SCANLINEIMAGE;
  parts.write(folder.path("lines.exr"));
  expect_scan(folder.path("lines.exr"));
}

TEST(ExrParts, OfTwoChannelsWithOneNameTheFirstCounts) {
  const ScanFolder folder;
  PartsFile().write(folder.path("two.exr"));
  io::ExrParts file(folder.path("two.exr"), 2);
  EXPECT_TRUE(file.complete());
  std::vector<float> range(kWidth * kHeight);
  Imf::FrameBuffer buffer;
  buffer.insert("range",
                Imf::Slice::Make(Imf::FLOAT, range.data(), file.header().dataWindow(), 4, 4 * kWidth));
  ASSERT_GE(file.band_rows(), kHeight);
  file.read(buffer, 0, kHeight);
  EXPECT_EQ(range[0], 1);
  EXPECT_EQ(range.back(), kWidth * kHeight);
}

TEST(ExrParts, PartsInDifferentPlacesAreRefused) {
  const ScanFolder folder;
  PartsFile parts;
  parts.points_window = {{4, -2}, {4 + kWidth - 1, -2 + kHeight - 1}};
  parts.write(folder.path("moved.exr"));
  expect_input_error([&] { io::read_exr_scan(folder.path("moved.exr")); },
                     {"moved.exr", "data window of the first, 70 x 90 from (3, -2)", "from (4, -2)"});
}

TEST(ExrParts, EveryCutIsFound) {
  const ScanFolder folder;
  PartsFile().write(folder.path("good.exr"));
  const std::string good = bytes_of(folder.path("good.exr"));
  const auto expect_refused = [&](std::size_t size) {
    const auto file = folder.write("cut.exr", good.substr(0, size));
    expect_input_error([&] { io::read_exr_scan(file); }, {file.string() + ": ", "expected"});
  };
  for (std::size_t size = 1; size < 1200; size += 11) expect_refused(size);
  for (std::size_t i = 1; i <= 40; ++i) expect_refused(i * (good.size() - 1) / 40);
}

}  // namespace
}  // namespace hybrid::testing::exr_parts_test
