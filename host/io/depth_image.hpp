#pragma once
#include <array>
#include <filesystem>

#include "geometry/pose.hpp"
#include "geometry/scan.hpp"

namespace hybrid::io {

// How a depth image's values become points.
struct DepthCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels; the centre of the upper left pixel is (0, 0)
  double scale = 0.001;                   // metres of one unit of the image
};

// A 16-bit grey PNG of depths along the optical axis (0, and 65535: no return) as a scan with one node per
// pixel, with notes on saturated pixels and a principal point far from the middle. Its
// frame is the scanner's: x forward, y left, z up, the origin at the camera's centre. Throws ErrorKind::input
// naming the file: no PNG, damaged, not one channel of 16 bits, no depth at all.
Scan read_depth_image(const std::filesystem::path& file, const DepthCamera& camera);

}  // namespace hybrid::io
