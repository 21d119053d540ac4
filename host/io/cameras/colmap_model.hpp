#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "io/cameras/camera_file.hpp"

namespace hybrid::io {

// What COLMAP's text and binary models have in common. All throw ErrorKind::input; `place` names file and
// line, or file and byte.

// A camera model: its parameters in file order, as members of Camera.
struct ColmapLens {
  int id;  // in binary models
  std::string_view name;
  std::vector<double Camera::*> parameters;
  bool one_focal_length = false;  // fx stands for both
  Lens lens = Lens::brown;
};
// Throws for models that are unknown or not supported, naming the remedy.
const ColmapLens& colmap_lens(const std::string& place, std::string_view name);
const ColmapLens& colmap_lens(const std::string& place, std::int64_t id);

// Puts cameras and images together and checks them.
class ColmapCollector {
 public:
  // `parameters` as many as the lens has.
  void add_camera(const std::string& place, std::int64_t id, const ColmapLens& lens, std::int64_t width,
                  std::int64_t height, const std::vector<double>& parameters);
  void add_image(const std::string& place, std::int64_t id, const Eigen::Quaterniond& rotation,
                 const Vec3& translation, std::int64_t camera, std::string_view name);
  CameraFile& file() { return file_; }

 private:
  CameraFile file_;
  std::unordered_map<std::int64_t, Camera> cameras_;
  std::unordered_set<std::int64_t> ids_;
  std::unordered_set<std::string> names_;
};

}  // namespace hybrid::io
