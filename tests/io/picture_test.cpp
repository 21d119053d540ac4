#include "io/picture.hpp"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>

#include "geometry/colour.hpp"
#include "io/exr/exr_header.hpp"
#include "io/files.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

// Writes `values` (0..65535, as many channels as fit) as a picture of the given type.
template <typename T>
fs::path write_with_oiio(const fs::path& file, int width, int height, const std::vector<T>& values,
                         OIIO::TypeDesc type, int orientation = 1,
                         OIIO::TypeDesc stored = OIIO::TypeUnknown) {
  const int channels = static_cast<int>(values.size()) / (width * height);
  OIIO::ImageSpec spec(width, height, channels, stored == OIIO::TypeUnknown ? type : stored);
  spec["oiio:UnassociatedAlpha"] = 1;
  if (orientation != 1) spec["Orientation"] = orientation;
  const auto output = OIIO::ImageOutput::create(file.string());
  EXPECT_TRUE(output && output->open(file.string(), spec) && output->write_image(type, values.data()) &&
              output->close())
      << file;
  return file;
}

Image8 gradient(int width, int height, int channels) {
  Image8 image(width, height, channels);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint8_t>(i * 7 + i / 11);
  return image;
}

std::vector<int> pixel(const Image8& image, int x, int y) {
  return {image.at(x, y), image.at(x, y) + image.channels};
}

TEST(picture, written_png_reads_back) {
  const TemporaryFolder folder;
  const Image8 image = gradient(13, 7, 3);
  write_png(folder.path() / "a.png", image);
  const Image8 back = read_photograph(folder.path() / "a.png", 13, 7);
  EXPECT_EQ(back.pixels, image.pixels);
  EXPECT_EQ(back.channels, 3);
}

// More rows than are looked at to choose the filter, of a kind each that either filter is better for.
TEST(picture, written_png_of_many_rows_reads_back_whichever_filter_is_better) {
  const TemporaryFolder folder;
  for (const int channels : {1, 3, 4})
    for (const bool smooth : {false, true}) {
      Image8 image(61, 300, channels);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          for (int c = 0; c < channels; ++c) {
            const int wave = 3 * x + 2 * y + 40 * c + (x * y) % 3, area = 60 * (x / 20) + 30 * (y / 100) + c;
            image.at(x, y)[c] = static_cast<std::uint8_t>(c == 3 ? 255 - wave % 200 : smooth ? wave : area);
          }
      const fs::path file = folder.path() / "a.png";
      write_png(file, image);
      const auto input = OIIO::ImageInput::open(file.string());
      ASSERT_TRUE(input);
      ASSERT_EQ(input->spec().nchannels, channels);
      OIIO::ImageSpec as_stored;
      as_stored["oiio:UnassociatedAlpha"] = 1;
      const auto straight = OIIO::ImageInput::open(file.string(), &as_stored);
      ASSERT_TRUE(straight);
      std::vector<std::uint8_t> back(image.pixels.size());
      ASSERT_TRUE(straight->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, back.data()));
      EXPECT_TRUE(std::equal(back.begin(), back.end(), image.pixels.begin(), image.pixels.end()))
          << channels << " channels, " << (smooth ? "smooth" : "flat");
    }
}

TEST(picture, grey_becomes_three_equal_channels) {
  const TemporaryFolder folder;
  write_png(folder.path() / "a.png", gradient(5, 4, 1));
  const Image8 back = read_photograph(folder.path() / "a.png", 0, 0);
  EXPECT_EQ(back.channels, 3);
  const int value = gradient(5, 4, 1).at(3, 2)[0];
  EXPECT_EQ(pixel(back, 3, 2), (std::vector<int>{value, value, value}));
}

// OpenImageIO would look for options behind the question mark.
TEST(picture, a_question_mark_in_a_path_is_part_of_it) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "why?" / "a?b=c.png";
  fs::create_directories(file.parent_path());
  const Image8 image = gradient(4, 3, 3);
  write_png(file, image);
  EXPECT_EQ(read_photograph(file, 4, 3).pixels, image.pixels);
  write_text(file, "no picture");
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { read_photograph(file, 4, 3); }), "a?b=c.png: is no picture"));
}

TEST(picture, alpha_is_dropped_and_never_multiplied) {
  const TemporaryFolder folder;
  Image8 image(2, 2, 4, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    image.pixels[4 * i] = 200;
    image.pixels[4 * i + 1] = 100;
    image.pixels[4 * i + 2] = 50;
    image.pixels[4 * i + 3] = static_cast<std::uint8_t>(85 * i);  // 0 = fully transparent, too
  }
  write_png(folder.path() / "a.png", image);
  const Image8 back = read_photograph(folder.path() / "a.png", 2, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) EXPECT_EQ(pixel(back, x, y), (std::vector<int>{200, 100, 50}));
}

TEST(picture, grey_with_alpha) {
  const TemporaryFolder folder;
  const auto file =
      write_with_oiio<std::uint8_t>(folder.path() / "a.png", 2, 1, {40, 128, 90, 0}, OIIO::TypeUInt8);
  const Image8 back = read_photograph(file, 2, 1);
  EXPECT_EQ(pixel(back, 0, 0), (std::vector<int>{40, 40, 40}));
  EXPECT_EQ(pixel(back, 1, 0), (std::vector<int>{90, 90, 90}));
}

TEST(picture, sixteen_bits_are_rounded_to_eight) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.tif"}) {
    const auto file = write_with_oiio<std::uint16_t>(
        folder.path() / name, 2, 1, {0, 65535, 128 * 257, 257, 257 + 100, 257 + 200}, OIIO::TypeUInt16);
    const Image8 back = read_photograph(file, 2, 1);
    EXPECT_EQ(pixel(back, 0, 0), (std::vector<int>{0, 255, 128})) << name;
    EXPECT_EQ(pixel(back, 1, 0), (std::vector<int>{1, 1, 2})) << name;
  }
}

// Linear light comes in, sRGB goes on: 0.5 of the light is the byte 188.
TEST(picture, floating_point_is_linear_light) {
  const TemporaryFolder folder;
  for (const char* name : {"a.exr", "a.tif"})
    for (const auto& type : {OIIO::TypeFloat, OIIO::TypeHalf}) {
      if (type == OIIO::TypeHalf && std::string(name) == "a.tif") continue;  // TIFF knows no half
      SCOPED_TRACE(name);
      const auto file = write_with_oiio<float>(
          folder.path() / name, 2, 1,
          {0.5f, 0.0f, 1.0f, 7.5f, -1.0f, std::numeric_limits<float>::quiet_NaN()}, OIIO::TypeFloat, 1, type);
      const Image8 back = read_photograph(file, 2, 1);
      EXPECT_EQ(pixel(back, 0, 0), (std::vector<int>{188, 0, 255}));
      EXPECT_EQ(pixel(back, 1, 0), (std::vector<int>{255, 0, 0}));
    }
}

// A TIFF that says sRGB (Exif ColorSpace 1) is that, floating point too.
TEST(picture, floating_point_that_says_srgb_is_srgb) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(2, 1, 3, OIIO::TypeFloat);
  spec["oiio:ColorSpace"] = "sRGB";
  const std::vector<float> values = {0.5f, 0.0f, 1.0f, 7.5f, -1.0f, std::numeric_limits<float>::quiet_NaN()};
  const auto file = (folder.path() / "a.tif").string();
  const auto output = OIIO::ImageOutput::create(file);
  ASSERT_TRUE(output && output->open(file, spec) && output->write_image(OIIO::TypeFloat, values.data()) &&
              output->close());
  const Image8 back = read_photograph(file, 2, 1);
  EXPECT_EQ(pixel(back, 0, 0), (std::vector<int>{128, 0, 255}));
  EXPECT_EQ(pixel(back, 1, 0), (std::vector<int>{255, 0, 0}));
}

TEST(picture, linear_integers_are_linear_light) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(1, 1, 3, OIIO::TypeUInt16);
  spec["oiio:ColorSpace"] = "Linear";
  const std::vector<std::uint16_t> values = {32768, 0, 65535};
  const auto file = (folder.path() / "a.png").string();  // PNG keeps it as a gamma of 1
  const auto output = OIIO::ImageOutput::create(file);
  ASSERT_TRUE(output && output->open(file, spec) && output->write_image(OIIO::TypeUInt16, values.data()) &&
              output->close());
  EXPECT_EQ(pixel(read_photograph(file, 1, 1), 0, 0), (std::vector<int>{188, 0, 255}));
}

TEST(picture, every_byte_survives_linear_light) {
  const TemporaryFolder folder;
  std::vector<float> linear;
  for (int i = 0; i < 256; ++i)
    for (int k = 0; k < 3; ++k) linear.push_back(static_cast<float>(linear_from_srgb(i / 255.0)));
  const auto file = write_with_oiio<float>(folder.path() / "a.exr", 256, 1, linear, OIIO::TypeFloat);
  const Image8 back = read_photograph(file, 256, 1);
  for (int i = 0; i < 256; ++i) EXPECT_EQ(pixel(back, i, 0), (std::vector<int>{i, i, i}));
}

TEST(picture, exr_files_that_are_no_photographs) {
  const TemporaryFolder folder;
  const auto refused = [&](const OIIO::ImageSpec& spec) {
    const auto file = (folder.path() / "a.exr").string();
    const std::vector<float> values(static_cast<std::size_t>(spec.width * spec.height * spec.nchannels));
    const auto output = OIIO::ImageOutput::create(file);
    EXPECT_TRUE(output && output->open(file, spec) && output->write_image(OIIO::TypeFloat, values.data()) &&
                output->close());
    return error_of(ErrorKind::input, [&] { read_photograph(file, 4, 3); });
  };
  OIIO::ImageSpec depth(4, 3, 1, OIIO::TypeFloat);
  depth.channelnames = {"range"};
  EXPECT_TRUE(holds(refused(depth), "expected the channels R, G, B or Y, found range"));
  OIIO::ImageSpec cropped(4, 3, 3, OIIO::TypeFloat);
  cropped.full_width = 8, cropped.full_height = 6, cropped.x = 2;
  EXPECT_TRUE(holds(refused(cropped), "expected a data window that is the display window (8 x 6 at 0, 0)"));
}

// OpenImageIO calls strips that do not decode a success.
TEST(picture, a_tiff_with_a_damaged_strip_is_no_photograph) {
  const TemporaryFolder folder;
  const auto file = (folder.path() / "a.tif").string();
  const Image8 image = gradient(200, 300, 3);
  for (const char* compression : {"zip", "lzw"})
    for (const int tile : {0, 64}) {
      SCOPED_TRACE(::testing::Message() << compression << " " << tile);
      OIIO::ImageSpec spec(200, 300, 3, OIIO::TypeUInt8);
      spec["compression"] = compression;
      spec.tile_width = spec.tile_height = tile;
      const auto output = OIIO::ImageOutput::create(file);
      ASSERT_TRUE(output && output->open(file, spec) &&
                  output->write_image(OIIO::TypeUInt8, image.pixels.data()) && output->close());
      EXPECT_EQ(read_photograph(file, 200, 300).pixels, image.pixels);
      std::string bytes = read_text(file);
      bytes.replace(bytes.size() / 2, 400, std::string(400, '\0'));
      write_text(file, bytes);
      EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_photograph(file, 200, 300); }),
                        "a.tif: does not decode:"));
    }
}

// OpenEXR takes a block without bytes for whole and gives what its memory held before.
TEST(picture, an_exr_that_lacks_a_block_is_no_photograph) {
  const TemporaryFolder folder;
  std::vector<float> values(3 * 40 * 300);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 97) / 97;
  const auto file =
      write_with_oiio<float>(folder.path() / "a.exr", 40, 300, values, OIIO::TypeFloat, 1, OIIO::TypeHalf);
  EXPECT_EQ(read_photograph(file, 40, 300).height, 300);
  std::string bytes = read_text(file);
  std::uint64_t table = 0, block = 0;
  {
    InputFile input(file);
    table = check_exr_header(input).end;
  }
  std::memcpy(&block, bytes.data() + table + 8 * 18, 8);  // the last
  bytes.replace(block + 4, 4, std::string(4, '\0'));
  write_text(file, bytes);
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { read_photograph(file, 40, 300); }),
            "a.exr: does not decode: expected 2880 bytes of pixels in 40 x 12 from (0, 288), found 0"));
}

TEST(picture, the_size_without_the_pixels) {
  const TemporaryFolder folder;
  const auto file = write_with_oiio<std::uint8_t>(folder.path() / "a.jpg", 31, 17, gradient(31, 17, 3).pixels,
                                                  OIIO::TypeUInt8, 6);
  EXPECT_EQ(picture_size(file).width, 31);  // as stored, whatever its orientation
  EXPECT_EQ(picture_size(file).height, 17);
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { picture_size(folder.path() / "none.jpg"); }),
                    "none.jpg: no such file"));
}

// The tag as cameras write it, in a JPEG's EXIF: right for a camera model of the stored and of the turned
// pixels.
TEST(picture, exif_of_a_jpeg_turns_it) {
  const TemporaryFolder folder;
  Image8 image(64, 32, 3, 0);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      if (x < 16 && y < 16) std::fill_n(image.at(x, y), 3, std::uint8_t{255});  // the top left corner
  const auto file =
      write_with_oiio<std::uint8_t>(folder.path() / "a.jpg", 64, 32, image.pixels, OIIO::TypeUInt8, 6);
  EXPECT_GT(pixel(read_photograph(file, 64, 32), 4, 4)[0], 200);
  const Image8 turned = read_photograph(file, 32, 64);  // "6": row 0 is the right side
  EXPECT_LT(pixel(turned, 4, 4)[0], 50);
  EXPECT_GT(pixel(turned, 27, 4)[0], 200);
}

TEST(picture, the_size_is_the_cameras) {
  const TemporaryFolder folder;
  write_png(folder.path() / "a.png", gradient(5, 4, 3));
  const std::string message =
      error_of(ErrorKind::input, [&] { read_photograph(folder.path() / "a.png", 4, 5); });
  EXPECT_TRUE(holds(message, "a.png: expected the camera's 4 x 5 pixels, found 5 x 4"));
}

// Where the picture as displayed has its stored pixel (0, 0): by TIFF's words, "row 0 is the right side,
// column 0 the top" puts it at the top right.
TEST(picture, quarter_turns_are_settled_by_the_size) {
  const TemporaryFolder folder;
  const int w = 3, h = 2;
  const Image8 stored = gradient(w, h, 3);
  const std::vector<std::array<int, 3>> corners = {
      {5, 0, 0}, {6, h - 1, 0}, {7, h - 1, w - 1}, {8, 0, w - 1}};
  for (const auto& [orientation, x, y] : corners) {
    SCOPED_TRACE(orientation);
    const auto file = write_with_oiio<std::uint8_t>(folder.path() / "a.tif", w, h, stored.pixels,
                                                    OIIO::TypeUInt8, orientation);
    EXPECT_EQ(read_photograph(file, w, h).pixels, stored.pixels);  // the camera means the pixels as stored
    const Image8 displayed = read_photograph(file, h, w);
    EXPECT_EQ(displayed.width, h);
    EXPECT_EQ(pixel(displayed, x, y), pixel(stored, 0, 0));
    // Stored neighbours along a row are displayed as neighbours along a column.
    EXPECT_EQ(pixel(displayed, x, y == 0 ? 1 : w - 2), pixel(stored, 1, 0));
    EXPECT_TRUE(
        holds(error_of(ErrorKind::input, [&] { read_photograph(file, 7, 9); }), "expected the camera's"));
  }
}

TEST(picture, orientations_that_the_size_cannot_settle_are_errors) {
  const TemporaryFolder folder;
  const auto refuse = [&](int w, int h, int orientation, int expected_w, int expected_h) {
    const auto file = write_with_oiio<std::uint8_t>(folder.path() / "a.tif", w, h, gradient(w, h, 3).pixels,
                                                    OIIO::TypeUInt8, orientation);
    const std::string message =
        error_of(ErrorKind::input, [&] { read_photograph(file, expected_w, expected_h); });
    EXPECT_TRUE(holds(message, "EXIF orientation is " + std::to_string(orientation)));
  };
  for (int orientation : {2, 3, 4}) refuse(3, 2, orientation, 3, 2);
  refuse(3, 3, 6, 3, 3);
  refuse(3, 2, 6, 0, 0);
}

// libjpeg fills what is missing with grey and reports success.
TEST(picture, a_jpeg_that_was_cut_is_an_error) {
  const TemporaryFolder folder;
  const Image8 image = gradient(64, 48, 3);
  const auto file =
      write_with_oiio<std::uint8_t>(folder.path() / "whole.jpg", 64, 48, image.pixels, OIIO::TypeUInt8);
  EXPECT_NO_THROW(read_photograph(file, 64, 48));
  const std::string bytes = bytes_of(file);
  for (std::size_t tenth = 1; tenth <= 10; ++tenth) {
    SCOPED_TRACE(tenth);
    const auto cut = folder.write("cut.jpg", bytes.substr(0, bytes.size() * tenth / 11));
    EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { read_photograph(cut, 64, 48); }), "cut.jpg"));
  }
}

TEST(picture, a_jpeg_that_is_damaged_is_an_error) {
  const TemporaryFolder folder;
  const Image8 image = gradient(640, 480, 3);
  const auto file =
      write_with_oiio<std::uint8_t>(folder.path() / "a.jpg", 640, 480, image.pixels, OIIO::TypeUInt8);
  const std::string good = bytes_of(file);
  std::string bytes = good;
  bytes.replace(bytes.size() / 2, 2, "\xff\xd3");  // a marker in the middle of the data
  folder.write("a.jpg", bytes);
  EXPECT_TRUE(
      holds(error_of(ErrorKind::input, [&] { read_photograph(file, 640, 480); }), "a.jpg: is damaged"));
  folder.write("a.jpg", std::string(good).insert(good.size() - 2, "padding"));  // before the last marker
  EXPECT_NO_THROW(read_photograph(file, 640, 480));
}

// Names of a PNG's chunks in order; of a text, its keyword, too.
std::vector<std::string> chunks(const std::string& png) {
  std::vector<std::string> names;
  for (std::size_t at = 8; at + 8 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(png[at + i]);
    const std::string name = png.substr(at + 4, 4);
    names.push_back(name == "tEXt" ? "tEXt " + std::string(png.c_str() + at + 8) : name);
    at += 12 + length;
  }
  return names;
}

// No time, no software version: two builds write the same bytes, too.
TEST(picture, png_has_no_changing_metadata) {
  const TemporaryFolder folder;
  write_png(folder.path() / "a.png", gradient(30, 20, 3));
  write_png(folder.path() / "deep/b.png", gradient(30, 20, 3));
  const std::string bytes = bytes_of(folder.path() / "a.png");
  EXPECT_EQ(bytes, bytes_of(folder.path() / "deep/b.png"));
  const std::set<std::string> fixed = {"IHDR", "sRGB", "gAMA", "cHRM", "oFFs", "tEXt oiio:ColorSpace",
                                       "IDAT", "IEND"};
  for (const std::string& name : chunks(bytes)) EXPECT_TRUE(fixed.contains(name)) << name;
}

TEST(picture, only_pictures_can_be_written) {
  const TemporaryFolder folder;
  for (const Image8& image : {Image8(0, 5, 3), Image8(5, 5, 2), Image8()}) {
    EXPECT_TRUE(
        holds(error_of(ErrorKind::failed, [&] { write_png(folder.path() / "a.png", image); }), "a.png"));
    EXPECT_FALSE(fs::exists(folder.path() / "a.png"));
  }
}

}  // namespace
}  // namespace hybrid::io
