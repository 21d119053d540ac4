#pragma once
#include "io/picture_library.hpp"

// The functions of io/picture.hpp, io/write_picture.hpp and io/depth_image.hpp by OpenImageIO.
namespace hybrid::pictures {

Image8 read_photograph(const std::filesystem::path& file, int expected_width, int expected_height);
void check_photograph(const std::filesystem::path& file, int expected_width, int expected_height);
Image8 decode_photograph(const io::PictureBytes& picture, const io::PictureBytes& mask,
                         const std::string& name, int expected_width, int expected_height);
io::PictureSize picture_size(const std::filesystem::path& file);
void write_jpeg(const std::filesystem::path& file, const Image8& image, int quality);
void write_best_jpeg(const std::filesystem::path& file, const Image8& image);
void write_tiff(const std::filesystem::path& file, const Image8& image);
void write_values_tiff(const std::filesystem::path& file, int width, int height,
                       const std::vector<float>& values);
Scan read_depth_image(const std::filesystem::path& file, const io::DepthCamera& camera);

}  // namespace hybrid::pictures
