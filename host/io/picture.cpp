#include "io/picture.hpp"

#include <array>
#include <fstream>
#include <string_view>

#include "core/error.hpp"
#include "io/exr/exr_errors.hpp"
#include "io/exr/exr_parts.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/picture_library.hpp"

namespace hybrid::io {
namespace {

bool is_exr(const std::filesystem::path& file) {
  std::array<char, 4> magic{};
  std::ifstream(file, std::ios::binary).read(magic.data(), magic.size());
  return std::string_view(magic.data(), magic.size()) == "\x76\x2f\x31\x01";
}

}  // namespace

Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height) {
  Image8 image = picture_library().read_photograph(file, expected_width, expected_height);
  if (is_exr(file))  // what the library does not find
    with_exr_errors([&] { ExrParts(file, start_exr_threads()).check(); },
                    [&](const char* what) {
                      fail_input("{}: does not decode: {}; copy or export it again", file.string(), what);
                    });
  return image;
}
void check_photograph(const std::filesystem::path& file, int expected_width, int expected_height) {
  picture_library().check_photograph(file, expected_width, expected_height);
}
Image8 decode_photograph(const PictureBytes& picture, const PictureBytes& mask, const std::string& name,
                         int expected_width, int expected_height) {
  return picture_library().decode_photograph(picture, mask, name, expected_width, expected_height);
}
PictureSize picture_size(const std::filesystem::path& file) {
  return picture_library().picture_size(file);
}
void write_jpeg(const std::filesystem::path& file, const Image8& image, int quality) {
  picture_library().write_jpeg(file, image, quality);
}

}  // namespace hybrid::io
