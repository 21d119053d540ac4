#include "io/depth_image.hpp"

#include "io/picture_library.hpp"

namespace hybrid::io {

Pose camera_from_depth_scan() {
  Mat3 rotation;
  rotation << 0, -1, 0,  //
      0, 0, -1,          //
      1, 0, 0;
  return {1, Eigen::Quaterniond(rotation), Vec3::Zero()};
}

Scan read_depth_image(const std::filesystem::path& file, const DepthCamera& camera) {
  return picture_library().read_depth_image(file, camera);
}

}  // namespace hybrid::io
