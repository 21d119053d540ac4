#pragma once
#include <filesystem>

#include "trace/render.hpp"

namespace synth {

void write_jpeg_or_png(const std::filesystem::path&,
                       const Picture8&);  // by extension; JPEG at quality 95, 4:4:4

}  // namespace synth
