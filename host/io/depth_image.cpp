#include "io/depth_image.hpp"

#include "io/picture_library.hpp"

namespace hybrid::io {

Scan read_depth_image(const std::filesystem::path& file, const DepthCamera& camera) {
  return picture_library().read_depth_image(file, camera);
}

}  // namespace hybrid::io
