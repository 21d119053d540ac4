#pragma once
#include "geometry/range_image.hpp"
#include "stages/planes/square_planes.hpp"

namespace hybrid::stages {

struct ContactLimits {
  double most_turn_rad;    // between the normals, beyond which an edge is between them
  double angle_sigmas;     // ... or this many of their standard deviations more
  double distance_factor;  // as SuperclusterOptions'
  double offset_sigmas;    // likewise
};

// Neighbouring squares a and b are of one surface that may bend: no step is between them. `a` is planar, `b`
// need not be.
bool in_contact(const RangeImage& image, const SquarePlanes& squares, const ContactLimits& limits,
                const SquareRecord& a, const SquareRecord& b);

}  // namespace hybrid::stages
