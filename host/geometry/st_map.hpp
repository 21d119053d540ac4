#pragma once
#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace hybrid {

// Whether a photograph of this camera differs from a pinhole's; panoramas have no pinhole and do not.
bool is_distorted(const Camera& camera);

// The pinhole camera of the same focal lengths whose picture holds all of the photograph, at most twice as
// wide and high; whole pixels are added, so that both pictures have the same centres of pixels at the axis.
Camera pinhole_of(const Camera& camera);

// Where to look in the `source` camera's picture for each pixel of the `target` camera's: two channels, s
// from 0 at the left border to 1 at the right, t from 0 at the lower border to 1 at the upper (the convention
// of ST maps in compositing); -1, -1 where the source does not see the direction.
ImageF st_map(const Camera& target, const Camera& source);

}  // namespace hybrid
