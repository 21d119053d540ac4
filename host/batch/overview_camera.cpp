#include "batch/overview_camera.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hybrid::batch {
namespace {

// All corners of the box lie in the picture, a twentieth of its height from the border.
bool holds(const Photograph& view, const Eigen::AlignedBox3d& box) {
  const double margin = 0.05 * view.camera.height;
  for (const auto corner : {Eigen::AlignedBox3d::BottomLeftFloor, Eigen::AlignedBox3d::BottomRightFloor,
                            Eigen::AlignedBox3d::TopLeftFloor, Eigen::AlignedBox3d::TopRightFloor,
                            Eigen::AlignedBox3d::BottomLeftCeil, Eigen::AlignedBox3d::BottomRightCeil,
                            Eigen::AlignedBox3d::TopLeftCeil, Eigen::AlignedBox3d::TopRightCeil}) {
    const auto pixel = view.camera.project(view.cam_from_world * box.corner(corner));
    if (!pixel || pixel->x() < margin || pixel->y() < margin || pixel->x() > view.camera.width - margin ||
        pixel->y() > view.camera.height - margin)
      return false;
  }
  return true;
}

// The nearest eye along a direction, to a percent, that sees all corners with a margin. The sphere around the
// box is seen from `far` in any case.
Photograph nearest_view(const Eigen::AlignedBox3d& box, const Vec3& direction, const Vec3& up, double fov_deg,
                        int width, int height) {
  const auto from = [&](double distance_m) {
    return look_at(box.center() + distance_m * direction, box.center(), up, fov_deg, width, height);
  };
  const double near = 0.5 * box.diagonal().norm(), far = 1.1 * near / std::sin(0.5 * fov_deg * M_PI / 180);
  double distance_m = far;
  while (distance_m > near && holds(from(0.99 * distance_m), box)) distance_m *= 0.99;
  return from(distance_m);
}

}  // namespace

Photograph overview_camera(const PolygonModel& model, int width, int height, bool from_behind) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : model.vertices) box.extend(vertex);
  return overview_camera(box, width, height, from_behind);
}

Photograph overview_camera(const Eigen::AlignedBox3d& box, int width, int height, bool from_behind) {
  const double side = from_behind ? -1 : 1;
  return nearest_view(box, Vec3(-0.45 * side, -0.75 * side, 0.85).normalized(), Vec3::UnitZ(), 40, width,
                      height);
}

Photograph plan_camera(const Eigen::AlignedBox3d& box, int width, int height) {
  return nearest_view(box, Vec3::UnitZ(), Vec3::UnitY(), 8, width, height);
}

}  // namespace hybrid::batch
