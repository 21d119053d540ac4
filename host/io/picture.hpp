#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "geometry/image.hpp"

namespace hybrid::io {

// A photograph through OpenImageIO as 8-bit sRGB RGB, grey or colour; alpha is dropped without
// premultiplying. Integers are taken as sRGB: 8 bits as they are, 16 bits (PNG, TIFF) rounded to 8, because
// the device holds photographs as 8-bit sRGB, as fine as the eye sees. Floating point (EXR, TIFF) and
// integers tagged as linear are linear light: encoded as sRGB and rounded, unless the file says that it is
// sRGB (a TIFF by the Exif tag ColorSpace = 1; OpenImageIO's oiio:ColorSpace). Of floating point what is
// above 1 is clipped and NaN black, both with a warning that tells the share. A colour profile other than
// sRGB is not applied (a warning names it). Throws ErrorKind::input: does not decode or is cut short, size
// differs from the camera's (expected_width 0 = any), an EXR without R, G, B or Y or with a data window that
// is not its display window. EXIF orientation: camera models may refer to the pixels as stored (COLMAP) or as
// displayed. A quarter turn of a photograph that is not square is settled by the camera's size, whichever way
// fits; where the size cannot tell (half turn, mirror, square, any size) it is an error that says how to
// settle it.
Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height);

// Throws what read_photograph throws of the file's header: all but pixels that do not decode.
void check_photograph(const std::filesystem::path& file, int expected_width, int expected_height);

// A photograph that lies in memory, inside another file; `name` says where, for messages. As read_photograph,
// but JPEG or PNG only, and the pixels as stored: the camera of such a file refers to them, whatever an EXIF
// orientation says. `mask`: another picture of its size, or empty; where it is black the result has alpha 0
// (4 channels then). What is allocated is bounded by what that many bytes can hold.
enum class PictureFormat { jpeg, png };
struct PictureBytes {
  std::span<const char> bytes{};
  PictureFormat format = PictureFormat::jpeg;
};
Image8 decode_photograph(const PictureBytes& picture, const PictureBytes& mask, const std::string& name,
                         int expected_width, int expected_height);

// Of the pixels as stored, without decoding them. Throws as read_photograph does.
struct PictureSize {
  int width = 0, height = 0;
};
PictureSize picture_size(const std::filesystem::path& file);

// 1, 3 or 4 channels, sRGB, alpha not premultiplied; no metadata that changes between runs. A picture
// that is handed over (std::move), with room for a byte more per row, is filtered in place.
void write_png(const std::filesystem::path& file, Image8 image);

// 1 or 3 channels, sRGB; quality 1 to 100. For pictures that are looked at, never measured.
void write_jpeg(const std::filesystem::path& file, const Image8& image, int quality);

}  // namespace hybrid::io
