#pragma once
#include <optional>
#include <string>

#include "geometry/pose.hpp"

namespace hybrid {

// What happens to a direction on its way to the film.
enum class Lens {
  brown,       // radial and tangential polynomials: COLMAP's SIMPLE_PINHOLE to OPENCV and FULL_OPENCV
  fisheye,     // a polynomial of the angle from the axis: COLMAP's *_FISHEYE models without thin prisms
  spherical,   // a panorama: columns are azimuths, rows are elevations (equirectangular)
  cylindrical  // a panorama: columns are azimuths, rows are heights on a cylinder around y
};

// Camera frame: x right, y down, z forward; the centre of the top left pixel is (0.5, 0.5). With
// x, y = X/Z, Y/Z and s = x^2 + y^2, pixel = (fx x' + cx, fy y' + cy), and for
//   brown:   q = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
//            x' = x q + 2 p1 x y + p2 (s + 2 x^2),  y' = y q + 2 p2 x y + p1 (s + 2 y^2)
//   fisheye: a = atan(sqrt s), q = a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8) / sqrt s,  x' = x q, y' = y q.
// These are OpenCV's formulas. A fisheye sees less than 90 degrees to each side: points with Z <= 0 are
// behind it and behind every brown camera. Panoramas have no distortion and see to all sides:
//   pixel = (fx atan2(X, Z) + cx, fy v + cy), fx in pixels per radian, and for
//   spherical:   v = atan2(Y, hypot(X, Z)), fy in pixels per radian;
//   cylindrical: v = Y / hypot(X, Z), fy the cylinder's radius in pixels.
// Columns that differ by a full turn, 2 pi fx, are the same direction.
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
  // direction projects: beyond the radius at which the distortion folds back, or above a panorama's zenith.
  Vec3 ray(const Vec2& pixel) const;
  // s up to which the radial distortion grows with the angle; infinite without distortion.
  double max_radius2() const;
  bool panorama() const { return lens == Lens::spherical || lens == Lens::cylindrical; }
  // A panorama of a full turn, up to half a pixel: its left and right borders are one line of the scene.
  bool wraps() const;
  // A spherical panorama whose first (last) row ends at the zenith (nadir), up to half a pixel: no border.
  bool reaches_zenith() const;
  bool reaches_nadir() const;
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

// A full panorama (Lens::spherical) from `eye`, twice as wide as high: `up` is its zenith, the direction to
// `target` its middle column. Errors as look_at(), and of a size that is not 2 : 1.
Photograph look_around(const Vec3& eye, const Vec3& target, const Vec3& up, int width, int height);

}  // namespace hybrid
