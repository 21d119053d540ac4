#include "pictures/functions.hpp"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/error.hpp"
#include "pictures/open_input.hpp"

namespace hybrid::pictures {
using namespace io;
namespace {

// What 16 bits cannot hold any more is no depth.
constexpr std::uint16_t kSaturated = 65535;

bool is_return(std::uint16_t depth) {
  return depth != 0 && depth != kSaturated;
}

// Intrinsics of a picture of another size, or in another order, bend all that is seen; those of a crop do
// not.
constexpr double kFarthestCentre = 0.2;

void check_centre(const DepthCamera& camera, Scan& scan) {
  const double right = (camera.cx - 0.5 * (scan.grid_cols - 1)) / scan.grid_cols,
               down = (camera.cy - 0.5 * (scan.grid_rows - 1)) / scan.grid_rows;
  if (std::max(std::abs(right), std::abs(down)) <= kFarthestCentre) return;
  scan.notes.push_back(
      fmt::format("intrinsics: expected fx, fy, cx, cy with cx, cy near the middle of its {} x {} pixels, "
                  "found {:g}, {:g}: are "
                  "they of a picture of another size, or in another order?",
                  scan.grid_cols, scan.grid_rows, camera.cx, camera.cy));
}

}  // namespace

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
  if (std::none_of(depths.begin(), depths.end(), is_return))
    fail_input("{}: expected depths, found 0 or {} (no return) in all {} x {} pixels", file.string(),
               kSaturated, spec.width, spec.height);

  Scan scan;
  scan.name = file.stem().string();
  scan.grid_rows = spec.height;
  scan.grid_cols = spec.width;
  scan.row_by_row = true;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  scan.points.assign(count, {kNan, kNan, kNan});
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_return(depths[i])) continue;
    const double depth = camera.scale * depths[i];
    const auto col = static_cast<double>(i % static_cast<std::size_t>(spec.width));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(spec.width));
    scan.points[i] = {static_cast<float>(depth), static_cast<float>(-depth * (col - camera.cx) / camera.fx),
                      static_cast<float>(-depth * (row - camera.cy) / camera.fy)};
  }
  if (const auto saturated = std::count(depths.begin(), depths.end(), kSaturated); saturated > 0)
    scan.notes.push_back(fmt::format("{} of {} pixels are {}, the most that 16 bits hold: taken as no return",
                                     saturated, count, kSaturated));
  check_centre(camera, scan);
  return scan;
}

}  // namespace hybrid::pictures
