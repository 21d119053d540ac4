#include "pictures/functions.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/log.hpp"
#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "pictures/open_input.hpp"

namespace hybrid::pictures {
using namespace io;
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 30;

using Input = std::unique_ptr<OIIO::ImageInput>;

Input open_picture(const fs::path& file) {
  OIIO::ImageSpec configuration;
  configuration["oiio:UnassociatedAlpha"] = 1;  // else colours arrive multiplied by alpha
  return open_input(file, configuration);
}

void check_size(const fs::path& file, const OIIO::ImageSpec& spec) {
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1 || spec.deep ||
      std::int64_t{spec.width} * spec.height > kMostPixels)
    fail_input("{}: expected one picture of at most 2^30 pixels, found {} x {} x {} with {} channels",
               file.string(), spec.width, spec.height, spec.depth, spec.nchannels);
}

// What the file says, as OpenImageIO understands it (of a TIFF, its Exif tag); else floating point is light.
bool is_linear(const OIIO::ImageSpec& spec) {
  const std::string space(spec.get_string_attribute("oiio:ColorSpace"));
  if (space == "sRGB") return false;
  return spec.format.is_floating_point() || space == "Linear" || space == "linear";
}

void check_pixels(const fs::path& file, const OIIO::ImageSpec& spec) {
  if (!spec.format.is_floating_point() && spec.format != OIIO::TypeUInt8 && spec.format != OIIO::TypeUInt16)
    fail_input("{}: expected 8 or 16 bits per channel or floating point, found {}; convert to 8-bit sRGB",
               file.string(), spec.format.c_str());
  const std::string profile(spec.get_string_attribute("ICCProfile:profile_description"));
  if (!profile.empty() && profile.find("sRGB") == std::string::npos)
    log::warning("{}: its colour profile \"{}\" is not applied: taken as sRGB", file.string(), profile);
}

// Of an EXR only; other formats number their channels.
void check_exr_channels(const fs::path& file, const OIIO::ImageSpec& spec) {
  const auto& names = spec.channelnames;
  const bool colour = names.size() >= 3 && names[0] == "R" && names[1] == "G" && names[2] == "B";
  const bool grey = names[0] == "Y" && names.size() <= 2;  // with alpha
  if (!colour && !grey)
    fail_input("{}: expected the channels R, G, B or Y, found {}; export it as an RGB picture", file.string(),
               fmt::join(names, ", "));
  if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
      spec.height != spec.full_height)
    fail_input(
        "{}: expected a data window that is the display window ({} x {} at {}, {}), found {} x {} at {}, {}; "
        "export it uncropped",
        file.string(), spec.full_width, spec.full_height, spec.full_x, spec.full_y, spec.width, spec.height,
        spec.x, spec.y);
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

template <typename T>
Image<T> decode(const fs::path& file, OIIO::ImageInput& input, const OIIO::ImageSpec& spec,
                OIIO::TypeDesc type) {
  Image<T> stored(spec.width, spec.height, spec.nchannels);
  bool read = true;
  if (std::string_view(input.format_name()) == "tiff" && spec.tile_width == 0) {
    // All lines at once, it calls a strip that does not decode a success, with what memory held before.
    for (int y = 0; y < spec.height && read; ++y)
      read = input.read_scanline(spec.y + y, 0, type, stored.at(0, y));
  } else {
    read = input.read_image(0, 0, 0, spec.nchannels, type, stored.pixels.data());
  }
  if (!read)
    fail_input("{}: does not decode: {}; copy or export it again", file.string(), reason(input.geterror()));
  if (input.has_error()) {
    // libjpeg fills the rows a cut file lacks with grey, goes on behind damage with whatever comes, and calls
    // both a success. Bytes before a marker that nobody needs are cameras' doing; its other remarks are
    // harmless.
    const std::string remark = reason(input.geterror());
    if (remark.find("Premature end") != std::string::npos)
      fail_input("{}: is cut short ({}); copy or export it again", file.string(), remark);
    const bool damaged = remark.find("Corrupt JPEG data") != std::string::npos ||
                         remark.find("Inconsistent progression") != std::string::npos;
    if (damaged && remark.find("extraneous bytes") == std::string::npos)
      fail_input("{}: is damaged ({}); copy or export it again", file.string(), remark);
    log::warning("{}: {}", file.string(), remark);
  }
  return stored;
}

// Of a value that is sRGB already.
std::uint8_t byte_of(float value) {
  return value > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0f))) : std::uint8_t{0};
}

// Linear light, or values that are sRGB already, as sRGB bytes; tells what does not fit.
Image8 encode(const fs::path& file, const ImageF& values, bool linear) {
  Image8 result(values.width, values.height, values.channels);
  parallel_for(static_cast<std::size_t>(values.height), [&](std::size_t row) {
    const std::size_t length =
        static_cast<std::size_t>(values.width) * static_cast<std::size_t>(values.channels);
    for (std::size_t i = row * length; i < (row + 1) * length; ++i)
      result.pixels[i] = linear ? srgb_byte_from_linear(values.pixels[i]) : byte_of(values.pixels[i]);
  });
  const auto count = static_cast<double>(values.pixels.size());
  const auto bright =
      std::count_if(values.pixels.begin(), values.pixels.end(), [](float v) { return v > 1; });
  const auto none =
      std::count_if(values.pixels.begin(), values.pixels.end(), [](float v) { return std::isnan(v); });
  if (bright > 0)
    log::warning("{}: {:.2f} % of its values are brighter than 1 and are clipped to 1", file.string(),
                 100 * static_cast<double>(bright) / count);
  if (none > 0)
    log::warning("{}: {:.2f} % of its values are no numbers and become black", file.string(),
                 100 * static_cast<double>(none) / count);
  return result;
}

// RGB of what is stored, grey or colour, turned as told.
Image8 rgb_of(Image8 stored, int orientation, int width, int height) {
  if (orientation == 1 && stored.channels == 3) return stored;
  Image8 result(width, height, 3);
  const int green = stored.channels >= 3 ? 1 : 0, blue = stored.channels >= 3 ? 2 : 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
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

struct Opened {
  Input input;
  OIIO::ImageSpec spec;
  int orientation;    // to apply
  int width, height;  // then
};

// Nothing is allocated before the size is checked, since a damaged header may say anything.
Opened open_photograph(const fs::path& file, int expected_width, int expected_height) {
  Opened opened{open_picture(file), {}, 1, 0, 0};
  opened.spec = opened.input->spec();
  const OIIO::ImageSpec& spec = opened.spec;
  check_size(file, spec);
  check_pixels(file, spec);
  if (std::string_view(opened.input->format_name()) == "openexr") check_exr_channels(file, spec);
  opened.orientation = orientation_to_apply(file, spec, expected_width, expected_height);
  opened.width = opened.orientation == 1 ? spec.width : spec.height;
  opened.height = opened.orientation == 1 ? spec.height : spec.width;
  if (expected_width != 0 && (opened.width != expected_width || opened.height != expected_height))
    fail_input(
        "{}: expected the camera's {} x {} pixels, found {} x {}; give the photograph the cameras were "
        "computed from",
        file.string(), expected_width, expected_height, spec.width, spec.height);
  return opened;
}

// Most pixels that a byte can stand for: a grey JPEG's block of 64 takes a bit at least, and deflate packs
// 1032 bytes of 8 pixels of one bit into one.
constexpr std::int64_t kJpegPixelsPerByte = 512, kPngPixelsPerByte = 1032 * 8;

// All channels of a picture in memory.
Image8 decode_bytes(const PictureBytes& picture, const std::string& name, int width, int height) {
  const bool png = picture.format == PictureFormat::png;
  OIIO::Filesystem::IOMemReader reader(const_cast<char*>(picture.bytes.data()), picture.bytes.size());
  OIIO::ImageSpec configuration, spec;
  configuration["oiio:UnassociatedAlpha"] = 1;
  const Input input = OIIO::ImageInput::create(png ? "png" : "jpeg");
  if (!input || !input->set_ioproxy(&reader) ||
      !input->open(png ? "memory.png" : "memory.jpg", spec, configuration))
    fail_input("{}: expected a {}, found something else: {}; export the file again", name,
               png ? "PNG" : "JPEG", reason(input ? input->geterror() : OIIO::geterror()));
  check_size(name, spec);
  check_pixels(name, spec);
  if (spec.width != width || spec.height != height)
    fail_input("{}: expected the {} x {} pixels of its description, found {} x {}; export the file again",
               name, width, height, spec.width, spec.height);
  const std::int64_t most =
      static_cast<std::int64_t>(picture.bytes.size()) * (png ? kPngPixelsPerByte : kJpegPixelsPerByte);
  if (std::int64_t{width} * height > most)
    fail_input(
        "{}: expected at most the {} pixels that {} bytes can hold, found {} x {}; export the file again",
        name, most, picture.bytes.size(), width, height);
  return decode<std::uint8_t>(name, *input, spec, OIIO::TypeUInt8);
}

}  // namespace

Image8 decode_photograph(const PictureBytes& picture, const PictureBytes& mask, const std::string& name,
                         int expected_width, int expected_height) {
  const Image8 rgb = rgb_of(decode_bytes(picture, name, expected_width, expected_height), 1, expected_width,
                            expected_height);
  if (mask.bytes.empty()) return rgb;
  const Image8 valid = decode_bytes(mask, name + ", its mask", expected_width, expected_height);
  const int colours = valid.channels >= 3 ? 3 : 1;
  Image8 result(rgb.width, rgb.height, 4);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x) {
      const std::uint8_t* from = valid.at(x, y);
      std::copy_n(rgb.at(x, y), 3, result.at(x, y));
      result.at(x, y)[3] = std::any_of(from, from + colours, [](int value) { return value != 0; }) ? 255 : 0;
    }
  return result;
}

Image8 read_photograph(const fs::path& file, int expected_width, int expected_height) {
  const Opened photograph = open_photograph(file, expected_width, expected_height);
  const auto& [input, spec, orientation, width, height] = photograph;
  const bool linear = is_linear(spec);
  Image8 stored = linear || spec.format.is_floating_point()
                      ? encode(file, decode<float>(file, *input, spec, OIIO::TypeFloat), linear)
                      : decode<std::uint8_t>(file, *input, spec, OIIO::TypeUInt8);
  return rgb_of(std::move(stored), orientation, width, height);
}

void check_photograph(const fs::path& file, int expected_width, int expected_height) {
  open_photograph(file, expected_width, expected_height);
}

PictureSize picture_size(const fs::path& file) {
  const OIIO::ImageSpec spec = open_picture(file)->spec();
  check_size(file, spec);
  return {spec.width, spec.height};
}

}  // namespace hybrid::pictures
