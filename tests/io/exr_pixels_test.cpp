// Tiles and blocks that we unpack ourselves, against the library.
#include "io/exr/exr_pixels.hpp"

#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include <random>

#include "io/exr/exr_parts.hpp"
#include "io/foreign_exr.hpp"
#include "io/scan_files.hpp"

namespace hybrid::testing {
namespace {

TEST(ExrPixels, BytesAreRestoredAsTheLibraryWouldOneByOne) {
  std::mt19937 random(2);
  for (const std::size_t size : {0u, 1u, 2u, 15u, 16u, 17u, 31u, 32u, 33u, 63u, 64u, 65u, 1000u, 1001u}) {
    std::string packed(size, '\0');
    for (char& byte : packed) byte = static_cast<char>(random());
    std::string sums = packed;
    for (std::size_t i = 1; i < size; ++i) sums[i] = static_cast<char>(sums[i - 1] + sums[i] - 128);
    std::string expected(size, '\0'), bytes(size, '?');
    for (std::size_t i = 0; i < size; ++i) expected[i] = sums[i % 2 == 0 ? i / 2 : (size + 1) / 2 + i / 2];
    io::restore_exr_bytes(packed, bytes);
    EXPECT_EQ(bytes, expected) << size;
  }
}

struct Values {
  std::vector<float> range, x;
  std::vector<std::uint32_t> mask;
  std::vector<half> colour;  // R and G of a node side by side

  explicit Values(std::size_t count) : range(count, -1), x(count, -1), mask(count, 9), colour(2 * count) {}
  Imf::FrameBuffer slices(const Imath::Box2i& window) {
    const auto wide = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    Imf::FrameBuffer buffer;
    const auto add = [&](const char* name, Imf::PixelType type, void* at, std::size_t step) {
      buffer.insert(name, Imf::Slice::Make(type, at, window, step, step * wide));
    };
    add("range", Imf::FLOAT, range.data(), 4);
    add("x", Imf::FLOAT, x.data(), 4);
    add("mask", Imf::UINT, mask.data(), 4);
    add("R", Imf::HALF, &colour[0], 4);
    add("G", Imf::HALF, &colour[1], 4);
    return buffer;
  }
};

// Lines and tiles that end within the image, a channel that nobody asks for, and one as whole words of which
// the file has halves, which is the library's.
TEST(ExrPixels, AreTheLibrarys) {
  const ScanFolder folder;
  constexpr int kWide = 45, kHigh = 301;
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION})
    for (const int tile : {0, 16})
      for (const bool halves : {false, true}) {
        ForeignExr exr(kWide, kHigh);
        exr.compression = compression;
        exr.tile = tile;
        exr.corner = {-3, 7};
        for (const char* name : {"R", "G", "unused"}) exr.add(name, Imf::HALF);
        for (const char* name : {"range", "x"}) exr.add(name, halves ? Imf::HALF : Imf::FLOAT);
        exr.add("mask", Imf::UINT);
        const auto file = folder.path("a.exr");
        exr.write(file);
        Values ours(kWide * kHigh), library(kWide * kHigh);
        io::ExrParts parts(file, 0);
        Imf::InputFile input(file.c_str());
        const Imath::Box2i window = input.header().dataWindow();
        EXPECT_EQ(io::can_put_exr_pixels(compression, input.header().channels(), ours.slices(window)),
                  !halves);
        parts.read(ours.slices(window), 0, parts.band_rows());
        parts.read(ours.slices(window), parts.band_rows(), kHigh - parts.band_rows());
        input.setFrameBuffer(library.slices(window));
        input.readPixels(window.min.y, window.max.y);
        EXPECT_EQ(ours.range, library.range);
        EXPECT_EQ(ours.x, library.x);
        EXPECT_EQ(ours.mask, library.mask);
        EXPECT_TRUE(std::equal(ours.colour.begin(), ours.colour.end(), library.colour.begin()));
        EXPECT_NE(ours.range[kWide * kHigh - 1], -1);
      }
}

// A table that leads to another block than it says.
TEST(ExrPixels, OfAnotherPlaceAreRefused) {
  const ScanFolder folder;
  for (const int tile : {0, 16}) {
    ForeignExr exr(40, 40);
    exr.tile = tile;
    exr.compression = Imf::ZIPS_COMPRESSION;
    for (const char* name : {"x", "y", "z"}) exr.add(name, Imf::FLOAT);
    exr.write(folder.path("a.exr"));
    std::string bytes = bytes_of(folder.path("a.exr"));
    io::InputFile input(folder.path("a.exr"));
    const std::uint64_t table = io::check_exr_header(input).end;
    bytes.replace(table + 8, 8, bytes.substr(table, 8));
    folder.write("a.exr", bytes);
    io::ExrParts parts(folder.path("a.exr"), 0);
    std::vector<float> x(1600);
    Imf::FrameBuffer buffer;
    buffer.insert("x", Imf::Slice::Make(Imf::FLOAT, x.data(), parts.header().dataWindow(), 4, 160));
    try {
      parts.read(buffer, 0, 40);
      ADD_FAILURE() << "read";
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(holds(error.what(), "calls itself 0 where 1 is expected")) << error.what();
    }
  }
}

}  // namespace
}  // namespace hybrid::testing
