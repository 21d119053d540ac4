#include "io/write_picture.hpp"

#include "io/picture_library.hpp"

namespace hybrid::io {

void write_jpeg(const std::filesystem::path& file, const Image8& image) {
  picture_library().write_best_jpeg(file, image);
}
void write_tiff(const std::filesystem::path& file, const Image8& image) {
  picture_library().write_tiff(file, image);
}
void write_tiff(const std::filesystem::path& file, int width, int height, const std::vector<float>& values) {
  picture_library().write_values_tiff(file, width, height, values);
}

}  // namespace hybrid::io
