#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "io/files.hpp"

namespace hybrid::testing {

// COLMAP's binary model written, and read a second time, by hand.
template <typename T>
std::string bytes(T value) {
  std::string result(sizeof(T), '\0');
  std::memcpy(result.data(), &value, sizeof(T));
  return result;
}

inline std::string colmap_camera_bytes(std::uint32_t id, std::int32_t model, std::uint64_t width,
                                       std::uint64_t height, const std::vector<double>& parameters) {
  std::string result = bytes(id) + bytes(model) + bytes(width) + bytes(height);
  for (double parameter : parameters) result += bytes(parameter);
  return result;
}

// Not turned, translation (1, 2, 3).
inline std::string colmap_image_bytes(std::uint32_t id, std::uint32_t camera, const std::string& name,
                                      std::uint64_t points) {
  std::string result = bytes(id);
  for (double value : {1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0}) result += bytes(value);
  result += bytes(camera) + name + '\0' + bytes(points);
  for (std::uint64_t i = 0; i < points; ++i) result += bytes(10.5) + bytes(20.5) + bytes(~std::uint64_t{0});
  return result;
}

// Distances of the points of points3D.bin to the keypoints of images.bin that saw them, ascending; infinite
// where the camera does not see the point.
inline std::vector<double> colmap_binary_errors_px(const std::filesystem::path& folder,
                                                   const std::vector<Photograph>& photographs) {
  std::ifstream images(folder / "images.bin", std::ios::binary),
      points(folder / "points3D.bin", std::ios::binary);
  const auto take = [](std::ifstream& in, auto value) {
    in.read(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  };
  std::map<std::uint64_t, Vec3> world;
  for (auto left = take(points, std::uint64_t{}); left > 0; --left) {
    const auto id = take(points, std::uint64_t{});
    for (int k = 0; k < 3; ++k) world[id][k] = take(points, double{});
    points.ignore(3 + 8);
    points.ignore(static_cast<std::streamsize>(8 * take(points, std::uint64_t{})));
  }
  std::vector<double> errors;
  for (auto left = take(images, std::uint64_t{}); left > 0; --left) {
    images.ignore(4 + 7 * 8 + 4);
    std::string name;
    std::getline(images, name, '\0');
    const auto photograph = std::find_if(photographs.begin(), photographs.end(),
                                         [&](const Photograph& p) { return p.name == name; });
    for (auto keypoints = take(images, std::uint64_t{}); keypoints > 0; --keypoints) {
      const double x = take(images, double{}), y = take(images, double{});
      const auto point = world.find(take(images, std::uint64_t{}));
      if (point == world.end()) continue;
      const auto pixel = photograph->camera.project(photograph->cam_from_world * point->second);
      errors.push_back(pixel ? (*pixel - Vec2(x, y)).norm() : std::numeric_limits<double>::infinity());
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

}  // namespace hybrid::testing
