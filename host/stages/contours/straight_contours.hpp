#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/contours/intersections.hpp"

namespace hybrid::stages {

// Moves contour points that lie on a line in which their plane meets another one (within two sample spacings,
// as mixed samples on the edge belong to neither plane) onto it, and where two such lines meet onto the
// corner of the three planes. Of a run of points on one line the first and the last stay. Rings stay closed
// and without self-intersections (make_simple), the largest first.
void straighten_contours(const RangeImage& image, const std::vector<Intersection>& intersections,
                         PlaneSegmentation& segmentation);

}  // namespace hybrid::stages
