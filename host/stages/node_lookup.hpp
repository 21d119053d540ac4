#pragma once
#include <array>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Row and column of the node whose ray is nearest to the direction of `point` (scan frame); straight above
// and below, any of its row. Of an image that does not go all around, the nearest at its border. Not of an
// image without nodes.
std::array<int, 2> node_towards(const RangeImage& image, const Vec3& point);

// Whether that ray is no farther than one step outside the image's rows and columns.
bool within_grid(const RangeImage& image, const Vec3& point);

}  // namespace hybrid::stages
