#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "geometry/camera.hpp"

namespace hybrid::io {

struct ColmapPoint {
  Vec3 position = Vec3::Zero();
  std::array<std::uint8_t, 3> rgb{};
};

// A COLMAP model in text: cameras.txt (PINHOLE, OPENCV, FULL_OPENCV or OPENCV_FISHEYE, one per different
// camera), images.txt (without 2D points) and points3D.txt (without tracks). Numbers read back as the same
// doubles, points have five decimals. Panoramas, which COLMAP has no model for, are left out; their names are
// returned.
std::vector<std::string> write_colmap(const std::filesystem::path& folder,
                                      const std::vector<Photograph>& photographs,
                                      const std::vector<ColmapPoint>& points);

// For each photograph the number of its camera, from 0; photographs with the same camera share one.
std::vector<std::size_t> number_cameras(const std::vector<Photograph>& photographs);

}  // namespace hybrid::io
