#pragma once
#include <filesystem>

#include "trace/render.hpp"
#include "trace/scanner.hpp"

namespace synth {

void write_jpeg_or_png(const std::filesystem::path&,
                       const Picture8&);  // by extension; JPEG at quality 95, 4:4:4

// Channels plane (uint), range (float), kind (uint: 0 planar, 1 curved, 2 mixed) per input sample, row-major
// at width 1024; the last row is filled up with 0 and NaN.
void write_truth_exr(const std::filesystem::path&, const Scan&);

}  // namespace synth
