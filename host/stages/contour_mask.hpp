#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// The masks that contours run around, as one label image: sample labels without specks. A 4-connected patch
// (across the seam where the image wraps) of fewer than `least` samples gives way to its surroundings:
// - a speck of a label becomes what most of its neighbours are;
// - a hole of unlabelled samples (dropouts, outliers, small things on a wall) is filled with the label that
//   makes up three quarters of its rim, if there is one.
// The image's border is no part of a rim.
std::vector<std::uint32_t> clean_labels(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                                        int least);

}  // namespace hybrid::stages
