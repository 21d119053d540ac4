#pragma once
#include <filesystem>
#include <vector>

#include "geometry/image.hpp"

namespace hybrid::io {

// sRGB, 3 channels, quality 95 without chroma subsampling.
void write_jpeg(const std::filesystem::path& file, const Image8& image);
// sRGB, 3 channels, deflated.
void write_tiff(const std::filesystem::path& file, const Image8& image);
// One channel of floats, width * height values, deflated.
void write_tiff(const std::filesystem::path& file, int width, int height, const std::vector<float>& values);

}  // namespace hybrid::io
