#pragma once
#include "geometry/camera.hpp"

namespace hybrid::stages {

// All directions that a photograph shows lie in this cone about its axis. World frame.
struct SightCone {
  Vec3 apex, axis;  // the photograph's centre; unit
  double half_rad;  // pi: all directions, of panoramas

  explicit SightCone(const Photograph& photograph);
  // False only where no point of the ball is in the photograph, whatever hides it.
  bool meets_ball(const Vec3& centre, double radius_m) const;
};

}  // namespace hybrid::stages
