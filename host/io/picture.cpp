#include "io/picture.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 30;

// OpenImageIO's own words on one line, for the tail of a message.
std::string reason(std::string message) {
  for (char& c : message)
    if (c == '\n' || c == '\r') c = ' ';
  return message.empty() ? "no reason given" : message;
}

void check_pixels(const fs::path& file, const OIIO::ImageSpec& spec) {
  if (spec.format != OIIO::TypeUInt8 && spec.format != OIIO::TypeUInt16)
    fail_input("{}: expected 8 or 16 bits per channel, found {}; convert to 8-bit sRGB", file.string(),
               spec.format.c_str());
  const std::string space(spec.get_string_attribute("oiio:ColorSpace"));
  if (space == "Linear" || space == "linear")
    fail_input("{}: expected sRGB values, found linear ones; convert to sRGB", file.string());
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1 ||
      std::int64_t{spec.width} * spec.height > kMostPixels)
    fail_input("{}: expected one picture of at most 2^30 pixels, found {} x {} x {} with {} channels",
               file.string(), spec.width, spec.height, spec.depth, spec.nchannels);
}

// The EXIF orientation to apply (1 = none), settled by the camera's size as the header describes.
int orientation_to_apply(const fs::path& file, const OIIO::ImageSpec& spec, int width, int height) {
  const int orientation = spec.get_int_attribute("Orientation", 1);
  if (orientation < 2 || orientation > 8) return 1;
  const bool quarter_turn = orientation >= 5;
  if (quarter_turn && spec.width != spec.height && width > 0) {
    if (spec.width == width && spec.height == height) return 1;
    if (spec.height == width && spec.width == height) return orientation;
    return 1;  // fits neither way: the size check tells
  }
  fail_input(
      "{}: its EXIF orientation is {} and its size cannot tell whether the camera model refers to the pixels "
      "as "
      "stored or as displayed; as stored (COLMAP): remove the tag (exiftool -Orientation= FILE), as "
      "displayed: "
      "turn the pixels (exiftran -ai FILE)",
      file.string(), orientation);
}

// Where pixel (x, y) of the displayed picture is stored, by TIFF 6.0's orientation numbers; w, h as stored.
std::array<int, 2> stored_position(int orientation, int x, int y, int w, int h) {
  switch (orientation) {
    case 5:  // row 0 = left side, column 0 = top
      return {y, x};
    case 6:  // row 0 = right side, column 0 = top
      return {y, h - 1 - x};
    case 7:  // row 0 = right side, column 0 = bottom
      return {w - 1 - y, h - 1 - x};
    case 8:  // row 0 = left side, column 0 = bottom
      return {w - 1 - y, x};
    default:
      return {x, y};
  }
}

Image8 decode(const fs::path& file, OIIO::ImageInput& input, const OIIO::ImageSpec& spec) {
  Image8 stored(spec.width, spec.height, spec.nchannels);
  const bool read = input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeUInt8, stored.pixels.data());
  if (!read)
    fail_input("{}: does not decode: {}; copy or export it again", file.string(), reason(input.geterror()));
  if (input.has_error()) {
    // libjpeg fills the rows a cut file lacks with grey and calls it a success; its other remarks are
    // harmless.
    const std::string remark = reason(input.geterror());
    if (remark.find("Premature end") != std::string::npos)
      fail_input("{}: is cut short ({}); copy or export it again", file.string(), remark);
    log::warning("{}: {}", file.string(), remark);
  }
  return stored;
}

}  // namespace

Image8 read_photograph(const fs::path& file, int expected_width, int expected_height) {
  check_readable(file);
  OIIO::ImageSpec configuration;
  configuration["oiio:UnassociatedAlpha"] = 1;  // else colours arrive multiplied by alpha
  const auto input = OIIO::ImageInput::open(file.string(), &configuration);
  if (!input) fail_input("{}: is no picture that can be read: {}", file.string(), reason(OIIO::geterror()));
  const OIIO::ImageSpec spec = input->spec();
  check_pixels(file, spec);
  const int orientation = orientation_to_apply(file, spec, expected_width, expected_height);
  Image8 result(orientation == 1 ? spec.width : spec.height, orientation == 1 ? spec.height : spec.width, 3);
  if (expected_width != 0 && (result.width != expected_width || result.height != expected_height))
    fail_input(
        "{}: expected the camera's {} x {} pixels, found {} x {}; give the photograph the cameras were "
        "computed from",
        file.string(), expected_width, expected_height, spec.width, spec.height);
  const Image8 stored = decode(file, *input, spec);
  const int green = stored.channels >= 3 ? 1 : 0, blue = stored.channels >= 3 ? 2 : 0;
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const auto [column, row] = stored_position(orientation, x, y, stored.width, stored.height);
      const std::uint8_t* from = stored.at(column, row);
      std::uint8_t* to = result.at(x, y);
      to[0] = from[0];
      to[1] = from[green];
      to[2] = from[blue];
    }
  }
  return result;
}

void write_png(const fs::path& file, const Image8& image) {
  if (image.width < 1 || image.height < 1 ||
      (image.channels != 1 && image.channels != 3 && image.channels != 4))
    fail(ErrorKind::failed, "{}: expected a picture of 1, 3 or 4 channels, found {} x {} with {}",
         file.string(), image.width, image.height, image.channels);
  // Encoded in memory: OpenImageIO does not look whether the last bytes of a file reached the disk.
  OIIO::Filesystem::IOVecOutput encoded;
  const auto output = OIIO::ImageOutput::create("png", &encoded);
  OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeUInt8);
  spec["oiio:ColorSpace"] = "sRGB";
  spec["oiio:UnassociatedAlpha"] = 1;
  if (!output || !output->open("memory.png", spec) ||
      !output->write_image(OIIO::TypeUInt8, image.pixels.data()) || !output->close())
    fail(ErrorKind::failed, "{}: cannot encode: {}", file.string(),
         reason(output ? output->geterror() : OIIO::geterror()));
  write_atomically(file, [&](const fs::path& temporary) {
    OutputFile out(temporary);
    out.write(encoded.buffer().data(), encoded.buffer().size());
    out.close();
  });
}

}  // namespace hybrid::io
