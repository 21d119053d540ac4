#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "io/depth_image.hpp"
#include "io/picture.hpp"

namespace hybrid::io {

// All that is done with OpenImageIO, in a library of our own (host/pictures) that is loaded when the first
// picture is read, or written as anything but PNG (io/png.cpp): it brings 240 others with it, whose loading
// takes a process a quarter of a second.
struct PictureLibrary {
  const char* interface;  // of which build: kPictureInterface there
  decltype(&io::read_photograph) read_photograph;
  decltype(&io::check_photograph) check_photograph;
  decltype(&io::decode_photograph) decode_photograph;
  decltype(&io::picture_size) picture_size;
  void (*write_jpeg)(const std::filesystem::path&, const Image8&, int quality);
  void (*write_best_jpeg)(const std::filesystem::path&, const Image8&);
  void (*write_tiff)(const std::filesystem::path&, const Image8&);
  void (*write_values_tiff)(const std::filesystem::path&, int width, int height, const std::vector<float>&);
  decltype(&io::read_depth_image) read_depth_image;
};

// A hash of the headers that program and library must have in common (host/CMakeLists.txt).
inline constexpr const char* kPictureInterface = HYBRID_PICTURE_INTERFACE;

// Throws ErrorKind::failed where it is not beside the program or of another build, or OpenImageIO is not
// installed.
const PictureLibrary& picture_library();

}  // namespace hybrid::io
