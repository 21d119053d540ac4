#pragma once
#include <filesystem>
#include <string>

#include "trace/render.hpp"

namespace synth {

// The file's bytes: ".jpg" at quality 95, 4:4:4, or ".png".
std::string encoded(const std::string& extension, const Picture8&);
void write_jpeg_or_png(const std::filesystem::path&,
                       const Picture8&);  // by extension

}  // namespace synth
