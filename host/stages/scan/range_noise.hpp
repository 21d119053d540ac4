#pragma once
#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Standard deviation of the noise along the rays, metres, at least 0.1 mm: for METHOD 2 where none is given.
// Three measured samples in consecutive rows of a column lie in one plane through the scanner, where a wall
// leaves a straight line: the middle one's distance from the line through its neighbours, along its ray, over
// the standard deviation of that distance for unit noise. Blocks of 16 x 16 nodes give the median of its
// size; the median over blocks is the noise as long as most blocks show smooth surfaces. At most about 4096
// blocks are looked at, on a fixed grid. 0.1 mm when nothing can be measured.
double estimate_range_noise(const RangeImage& image);

}  // namespace hybrid::stages
