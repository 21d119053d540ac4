#pragma once
#include "geometry/range_image.hpp"

namespace hybrid {

// make_range_image() where `source`, of that extent, is known already: taken as it is, everything else empty.
RangeImage make_range_image(int rows, int cols, std::vector<std::uint32_t> source);

}  // namespace hybrid
