#include "write/colmap.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "write/files.hpp"

namespace synth {

void write_colmap(const std::filesystem::path& folder, const std::vector<Camera>& cameras) {
  const Camera& lens = cameras.front();
  write_bytes(folder / "cameras.txt",
              fmt::format("# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[] (RADIAL: f, cx, cy, k1, k2)\n"
                          "1 RADIAL {} {} {} {} {} {} {}\n",
                          lens.width_px, lens.height_px, lens.focal_px, lens.centre_x_px, lens.centre_y_px,
                          lens.k1, lens.k2));
  std::string images =
      "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME (camera from world)\n"
      "# POINTS2D[] as (X, Y, POINT3D_ID): none\n";
  int id = 0;
  for (const Camera& camera : cameras) {
    Eigen::Quaterniond q(camera.camera_from_world_rotation);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const Vec3 t = camera.translation();
    images += fmt::format("{} {} {} {} {} {} {} {} 1 {}\n\n", ++id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                          t.z(), camera.name);
  }
  write_bytes(folder / "images.txt", images);
  write_bytes(
      folder / "points3D.txt",
      "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n# Number of points: 0\n");
}

}  // namespace synth
