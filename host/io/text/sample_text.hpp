#pragma once
#include <string>

#include "io/scan_stream.hpp"

namespace hybrid::io {

// The shortest decimal that is this number again.
void append_number(std::string& text, double value);
void append_number(std::string& text, float value);
// "x y z", the shortest decimals that a reader turns into the same sample: where the scan has an origin, of
// that sum no more digits than the sample has. Of exact coordinates the shortest that are the same double, or
// the same whole number of the file's steps. A no-return is "0 0 0".
void append_point(std::string& text, const SampleBlock& block, std::size_t sample);
void append_colour(std::string& text, const std::array<std::uint8_t, 3>& rgb);  // " r g b"

}  // namespace hybrid::io
