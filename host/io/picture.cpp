#include "io/picture.hpp"

#include "io/picture_library.hpp"

namespace hybrid::io {

Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height) {
  return picture_library().read_photograph(file, expected_width, expected_height);
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
