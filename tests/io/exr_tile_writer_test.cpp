#include "io/exr/exr_tile_writer.hpp"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputFile.h>
#include <ImfVersion.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "core/error.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

// An image whose window lies off the origin, of 5 x 3 tiles, of which the last ones are cut; one channel is
// noise, which deflating makes longer, one is half of a pixel of three.
struct Picture {
  static constexpr int kWidth = 70, kHeight = 43, kSide = 16;
  Imath::Box2i window{{-5, 7}, {-5 + kWidth - 1, 7 + kHeight - 1}};
  std::vector<float> range = std::vector<float>(kWidth * kHeight);
  std::vector<std::uint32_t> noise = std::vector<std::uint32_t>(kWidth * kHeight), same = noise;
  std::vector<half> colour = std::vector<half>(3 * kWidth * kHeight);

  Picture() {
    std::minstd_rand random(3);
    for (std::size_t i = 0; i < range.size(); ++i) {
      range[i] = static_cast<float>(i) / 7;
      noise[i] = static_cast<std::uint32_t>(random() * 2u + random());
      same[i] = 4;
      for (std::size_t c = 0; c < 3; ++c) colour[3 * i + c] = static_cast<float>((i + c) % 100);
    }
  }

  Imf::Header header() const {
    Imf::Header header(window, window);
    header.setTileDescription(Imf::TileDescription(kSide, kSide));
    header.channels().insert("range", Imf::Channel(Imf::FLOAT));
    header.channels().insert("noise", Imf::Channel(Imf::UINT));
    header.channels().insert("same", Imf::Channel(Imf::UINT));
    header.channels().insert("G", Imf::Channel(Imf::HALF));
    header.insert("hybrid:a name longer than thirty-one bytes", Imf::StringAttribute("kept"));
    return header;
  }

  Imf::FrameBuffer slices() {
    Imf::FrameBuffer buffer;
    const auto add = [&](const char* name, Imf::PixelType type, void* at, std::size_t step) {
      buffer.insert(name, Imf::Slice::Make(type, at, window.min, kWidth, kHeight, step, step * kWidth));
    };
    add("range", Imf::FLOAT, range.data(), 4);
    add("noise", Imf::UINT, noise.data(), 4);
    add("same", Imf::UINT, same.data(), 4);
    add("G", Imf::HALF, &colour[1], 3 * sizeof(half));
    return buffer;
  }

  // In bands of two rows of tiles.
  void write(const std::filesystem::path& file, const Imf::Header& header) {
    const std::vector<io::ExrPart> parts = {{"range", Imf::NO_COMPRESSION, {"range"}},
                                            {"marks", Imf::ZIP_COMPRESSION, {"noise", "absent"}},
                                            {"more", Imf::ZIP_COMPRESSION, {"same", "G"}},
                                            {"none", Imf::ZIP_COMPRESSION, {"absent"}}};
    io::write_exr_stream(file, [&](io::ExrStream& stream) {
      io::ExrTileWriter out(stream, header, parts);
      for (int row = 0; row < kHeight; row += 2 * kSide)
        out.write(slices(), row, std::min(2 * kSide, kHeight - row));
      out.finish();
    });
  }
};

TEST(ExrTileWriter, OpenExrReadsWhatItWrites) {
  const ScanFolder folder;
  Picture picture;
  picture.write(folder.path("a.exr"), picture.header());
  Picture read;
  std::ranges::fill(read.range, 0.0f);
  std::ranges::fill(read.noise, 0u);
  std::ranges::fill(read.same, 0u);
  for (std::size_t i = 1; i < read.colour.size(); i += 3) read.colour[i] = 0.0f;
  io::ExrParts file(folder.path("a.exr"), 0);
  EXPECT_TRUE(file.complete());
  const auto* kept =
      file.header().findTypedAttribute<Imf::StringAttribute>("hybrid:a name longer than thirty-one bytes");
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->value(), "kept");
  EXPECT_EQ(file.header().dataWindow(), picture.window);
  for (int row = 0; row < Picture::kHeight; row += file.band_rows())
    file.read(read.slices(), row, std::min(file.band_rows(), Picture::kHeight - row));
  EXPECT_EQ(read.range, picture.range);
  EXPECT_EQ(read.noise, picture.noise);
  EXPECT_EQ(read.same, picture.same);
  EXPECT_EQ(read.colour, picture.colour);
}

// A part alone is the image of a file without parts.
TEST(ExrTileWriter, OpenExrReadsOnePartAsAnImage) {
  const ScanFolder folder;
  Picture picture;
  const std::vector<io::ExrPart> parts = {{"", Imf::ZIP_COMPRESSION, {"range", "noise", "same", "G"}}};
  io::write_exr_stream(folder.path("a.exr"), [&](io::ExrStream& stream) {
    io::ExrTileWriter out(stream, picture.header(), parts);
    out.write(picture.slices(), 0, Picture::kHeight);
    out.finish();
  });
  Picture read;
  std::ranges::fill(read.range, 0.0f);
  std::ranges::fill(read.noise, 0u);
  std::ranges::fill(read.same, 0u);
  for (std::size_t i = 1; i < read.colour.size(); i += 3) read.colour[i] = 0.0f;
  Imf::TiledInputFile file(folder.path("a.exr").c_str());  // refuses files of several parts
  EXPECT_TRUE(file.isComplete());
  EXPECT_FALSE(Imf::isMultiPart(file.version()));
  file.setFrameBuffer(read.slices());
  file.readTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  EXPECT_EQ(read.range, picture.range);
  EXPECT_EQ(read.noise, picture.noise);
  EXPECT_EQ(read.same, picture.same);
  EXPECT_EQ(read.colour, picture.colour);
}

TEST(ExrTileWriter, BytesAreTheSameForAnyNumberOfThreads) {
  const ScanFolder folder;
  Picture picture;
  picture.write(folder.path("many.exr"), picture.header());
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    picture.write(folder.path("one.exr"), picture.header());
  }
  EXPECT_EQ(bytes_of(folder.path("many.exr")), bytes_of(folder.path("one.exr")));
}

TEST(ExrTileWriter, ChannelOfAnotherTypeIsAnError) {
  const ScanFolder folder;
  Picture picture;
  Imf::Header header = picture.header();
  header.channels().insert("same", Imf::Channel(Imf::FLOAT));
  EXPECT_THROW(picture.write(folder.path("a.exr"), header), Error);
}

}  // namespace
}  // namespace hybrid::testing
