#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// A run of samples whose label was another one.
struct LabelChange {
  std::size_t begin, end;
  std::uint32_t before;
};

// Makes of sample labels the masks that contours run around, as one label image: labels without specks. A
// 4-connected patch (across the seam where the image wraps) of fewer than `least` samples gives way to its
// surroundings:
// - a speck of a label becomes what most of its neighbours are;
// - a hole of unlabelled samples (dropouts, outliers, small things on a wall) is filled with the label that
//   makes up three quarters of its rim, if there is one.
// The image's border is no part of a rim. Returns what it changed, in its order.
std::vector<LabelChange> clean_labels(const RangeImage& image, std::vector<std::uint32_t>& labels, int least);
void restore_labels(const std::vector<LabelChange>& changes, std::vector<std::uint32_t>& labels);

}  // namespace hybrid::stages
