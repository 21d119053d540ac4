#pragma once
#include <optional>
#include <string>

#include "geometry/pose.hpp"

namespace hybrid {

// What happens to a direction on its way to the film.
enum class Lens {
  brown,   // radial and tangential polynomials: COLMAP's SIMPLE_PINHOLE to OPENCV and FULL_OPENCV
  fisheye  // a polynomial of the angle from the axis: COLMAP's *_FISHEYE models without thin prisms
};

// Camera frame: x right, y down, z forward; the centre of the top left pixel is (0.5, 0.5). With
// x, y = X/Z, Y/Z and s = x^2 + y^2, pixel = (fx x' + cx, fy y' + cy), and for
//   brown:   q = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
//            x' = x q + 2 p1 x y + p2 (s + 2 x^2),  y' = y q + 2 p2 x y + p1 (s + 2 y^2)
//   fisheye: a = atan(sqrt s), q = a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8) / sqrt s,  x' = x q, y' = y q.
// These are OpenCV's formulas. A fisheye sees less than 90 degrees to each side: points with Z <= 0 are
// behind every camera.
struct Camera {
  int width = 0, height = 0;
  double fx = 1, fy = 1, cx = 0, cy = 0;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;
  double k3 = 0, k4 = 0, k5 = 0, k6 = 0;
  Lens lens = Lens::brown;

  // Where the camera sees a point of its own frame; nothing when it lies behind, beyond the radius at which
  // the distortion folds back, or outside the image.
  std::optional<Vec2> project(const Vec3& point_in_cam) const;
  // Unit direction of a pixel position in the camera frame (Newton's method on the distortion). NaN where no
  // direction projects: beyond the radius at which the distortion folds back.
  Vec3 ray(const Vec2& pixel) const;
  // s up to which the radial distortion grows with the angle; infinite without distortion.
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
