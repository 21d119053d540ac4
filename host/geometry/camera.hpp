#pragma once
#include <optional>
#include <string>

#include "geometry/pose.hpp"

namespace hybrid {

// Pinhole with radial (k1, k2) and tangential (p1, p2) distortion: the union of COLMAP's SIMPLE_PINHOLE,
// PINHOLE, SIMPLE_RADIAL, RADIAL and OPENCV. Camera frame: x right, y down, z forward; the centre of the top
// left pixel is (0.5, 0.5). With x, y = X/Z, Y/Z and r2 = x^2 + y^2:
//   x' = x (1 + k1 r2 + k2 r2^2) + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y (1 + k1 r2 + k2 r2^2) + 2 p2 x y + p1 (r2 + 2 y^2),   pixel = (fx x' + cx, fy y' + cy).
struct Camera {
  int width = 0, height = 0;
  double fx = 1, fy = 1, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;

  // Where the camera sees a point of its own frame; nothing when it lies behind, beyond the radius at which
  // the distortion folds back, or outside the image.
  std::optional<Vec2> project(const Vec3& point_in_cam) const;
  // Unit direction of a pixel position in the camera frame (Newton's method on the distortion).
  Vec3 ray(const Vec2& pixel) const;
  // r2 up to which the radial distortion is monotonic; infinite without distortion.
  double max_radius2() const;
};

struct Photograph {
  std::string name;  // file name as in the camera model
  Camera camera;
  Pose cam_from_world;  // scale 1

  Vec3 centre() const { return cam_from_world.inverse().translation; }
};

// A distortion-free camera at `eye` looking at `target`, fov_deg vertical, square pixels. Throws
// ErrorKind::input when eye and target coincide, `up` is parallel to the view direction or a number is not
// finite.
Photograph look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double fov_deg, int width,
                   int height);

}  // namespace hybrid
