#pragma once
#include <filesystem>
#include <string>

#include "geometry/image.hpp"

namespace hybrid::report {

// The picture made smaller by the least whole factor that brings it to `largest_width`: each pixel is the
// mean light of a block (sRGB in and out). As it is when it is no wider.
Image8 shrink(const Image8& picture, int largest_width);

// What the page shows of DIR/<picture>: DIR/report/pictures/<picture>.jpg, at most 1200 pixels wide, so that
// a page with hundreds of pictures opens on a phone and report/ can be sent alone. Returns its path in
// report/, or nothing when there is no such picture (its stage was not run, or failed).
std::string write_preview(const std::filesystem::path& out, const std::string& picture);

}  // namespace hybrid::report
