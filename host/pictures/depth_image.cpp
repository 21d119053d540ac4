#include "pictures/functions.hpp"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/error.hpp"
#include "pictures/open_input.hpp"

namespace hybrid::pictures {
using namespace io;

Scan read_depth_image(const std::filesystem::path& file, const DepthCamera& camera) {
  const auto input = open_input(file);
  const OIIO::ImageSpec& spec = input->spec();
  constexpr int kLargest_px = 32768;
  if (std::string(input->format_name()) != "png" || spec.nchannels != 1 || spec.format != OIIO::TypeUInt16)
    fail_input(
        "{}: expected a depth image, a PNG of one channel with 16 bits, found {} of {} channels with {} "
        "bits; "
        "export depths, not colours",
        file.string(), input->format_name(), spec.nchannels, 8 * spec.format.size());
  if (spec.width > kLargest_px || spec.height > kLargest_px)
    fail_input("{}: expected at most {} pixels a side, found {} x {}", file.string(), kLargest_px, spec.width,
               spec.height);
  const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<std::uint16_t> depths(count);
  if (!input->read_image(0, 0, 0, 1, OIIO::TypeUInt16, depths.data()))
    fail_input("{}: damaged or cut short: {}", file.string(), input->geterror());
  if (std::all_of(depths.begin(), depths.end(), [](std::uint16_t d) { return d == 0; }))
    fail_input("{}: expected depths, found 0 (no return) in all {} x {} pixels", file.string(), spec.width,
               spec.height);

  Scan scan;
  scan.name = file.stem().string();
  scan.grid_rows = spec.height;
  scan.grid_cols = spec.width;
  scan.row_by_row = true;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  scan.points.assign(count, {kNan, kNan, kNan});
  for (std::size_t i = 0; i < count; ++i) {
    if (depths[i] == 0) continue;
    const double depth = camera.scale * depths[i];
    const auto col = static_cast<double>(i % static_cast<std::size_t>(spec.width));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(spec.width));
    scan.points[i] = {static_cast<float>(depth), static_cast<float>(-depth * (col - camera.cx) / camera.fx),
                      static_cast<float>(-depth * (row - camera.cy) / camera.fy)};
  }
  return scan;
}

}  // namespace hybrid::pictures
