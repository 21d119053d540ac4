#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>

#include "geometry/mesh.hpp"
#include "world/options.hpp"

namespace synth {

// COLMAP's RADIAL model: x right, y down, z forward, the first pixel's centre at (0.5, 0.5). Or a panorama of
// the whole sphere: columns are azimuths to the right of z, rows are elevations, focal_px pixels per radian.
struct Camera {
  std::string name;
  int width_px = 0, height_px = 0;
  double focal_px = 0, centre_x_px = 0, centre_y_px = 0, k1 = 0, k2 = 0;
  Eigen::Matrix3d camera_from_world_rotation = Eigen::Matrix3d::Identity();
  Vec3 eye = Vec3::Zero();  // world
  double exposure = 1;      // factor on what reaches the lens
  bool spherical = false;

  Vec3 ray_direction(double x_px, double y_px) const;                        // unit, world frame
  std::optional<Eigen::Vector2d> project(const Vec3& point_in_world) const;  // nothing: behind or outside
  Vec3 translation() const { return -(camera_from_world_rotation * eye); }
};

// Rows right, down, forward; roll turns the camera about its axis.
Eigen::Matrix3d look_at(const Vec3& eye, const Vec3& target, const Vec3& up, double roll_rad = 0);

// The lens every photograph is taken with, off centre and with radial distortion; named 000.jpg and on. Where
// it stands and looks is left to the caller.
Camera photograph_camera(std::size_t index, const Preset&, double horizontal_fov_deg);

// The whole sphere around a scanner, its x axis in the middle, its z axis up.
Camera panorama(const std::string& name, int width_px, const Eigen::Matrix3d& world_from_scan_rotation,
                const Vec3& eye);

Camera pinhole(const std::string& name, int width_px, int height_px, double vertical_fov_deg, const Vec3& eye,
               const Vec3& target);

}  // namespace synth
