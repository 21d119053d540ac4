#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "score/geometry.hpp"

namespace score {

// COLMAP's radial models: x right, y down, z forward; the first pixel's centre is (0.5, 0.5).
struct Camera {
  std::string name;
  int width_px = 0, height_px = 0;
  double focal_x_px = 0, focal_y_px = 0, centre_x_px = 0, centre_y_px = 0, k1 = 0, k2 = 0;
  double fold_radius = 1e9;  // tangent of the angle to the axis beyond which k1 and k2 say nothing
  Mat3 world_from_camera = Mat3::Identity();  // rotation
  Vec3 eye = Vec3::Zero();                    // world

  Vec3 ray(double x_px, double y_px) const;  // unit, world
  std::optional<Vec2> pixel_of(
      const Vec3& in_world) const;  // nothing: behind the camera or outside its image
};

// An entry of truth.json's "cameras" or "views". Throws InputError for a model this program does not know.
Camera json_camera(const nlohmann::json& entry);

}  // namespace score
